#pragma once

#include <cstdint>
#include <span>

#include "firmware/canopen/domain.h"
#include "firmware/robot/model.h"
#include "firmware/storage/item_store.h"
#include "firmware/storage/motion_library.h"

namespace koboshi::storage {

// Motion images on their way between an SDO client and storage, one at a time. What arrives goes straight
// into a spare slot and counts only once it is complete and plays on this robot.
class MotionTransfer final : public canopen::Domain {
 public:
  // `motions` hears of what has been stored. All must outlive the transfer.
  MotionTransfer(ItemStore& items, const robot::RobotModel& model, MotionLibrary& motions)
      : items_(items), model_(model), motions_(motions) {}

  // Which motion the next transfer is about, its bytes as they are (none: there is none), and whether it may
  // be replaced. Nothing happens while a transfer is under way.
  void select(std::uint16_t number, std::span<const std::byte> image, bool may_store);

  canopen::AbortCode begin_upload(std::uint32_t& size_bytes) override;
  std::size_t read(std::uint32_t position, std::span<std::uint8_t> bytes) override;
  canopen::AbortCode begin_download(std::uint32_t size_bytes) override;
  canopen::AbortCode write(std::span<const std::uint8_t> bytes) override;
  canopen::AbortCode commit() override;
  void release() override;

 private:
  enum class Activity : std::uint8_t { kNone, kUpload, kDownload };

  ItemStore& items_;
  const robot::RobotModel& model_;
  MotionLibrary& motions_;
  std::span<const std::byte> image_;
  std::uint16_t number_ = 0;
  bool may_store_ = false;
  Activity activity_ = Activity::kNone;
  motion::Motion checked_;  // what was downloaded and is valid; empty before
};

}  // namespace koboshi::storage
