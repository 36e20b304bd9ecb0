#pragma once

#include <cstdint>
#include <span>

#include "firmware/canopen/sdo/objects.h"
#include "firmware/motion/motion_library.h"
#include "firmware/robot/model.h"
#include "firmware/storage/item_store.h"

namespace koboshi::app {

// Transfers motion images between an SDO client and storage, one at a time: the DOMAIN behind object 0x2400.
// A download goes straight into the log, and counts only once it is complete and valid for this robot. A
// motion that is being uploaded stays in place until then.
class MotionTransfer final : public canopen::Domain {
 public:
  // Adds each stored motion to `motions`. All must outlive the transfer.
  MotionTransfer(storage::ItemStore& items, const robot::RobotModel& model, motion::MotionLibrary& motions)
      : items_(items), model_(model), motions_(motions) {}

  // Selects the motion of the next transfer, 0..kMaxMotions - 1, and whether a client may replace it. Does
  // nothing while a transfer is under way.
  void select(std::uint16_t number, bool may_store);

  canopen::AbortCode begin_upload(std::uint32_t& size_bytes) override;
  std::size_t read(std::uint32_t position, std::span<std::uint8_t> bytes) override;
  canopen::AbortCode begin_download(std::uint32_t size_bytes) override;
  canopen::AbortCode write(std::span<const std::uint8_t> bytes) override;
  // kInvalidValue unless the bytes are exactly one motion image that this robot can play.
  canopen::AbortCode commit() override;
  void release() override;

 private:
  enum class Activity : std::uint8_t { kNone, kUpload, kDownload };

  storage::ItemStore& items_;
  const robot::RobotModel& model_;
  motion::MotionLibrary& motions_;
  std::span<const std::byte> image_;  // of the selected motion; empty: there is none
  std::uint16_t number_ = 0;
  bool may_store_ = false;
  Activity activity_ = Activity::kNone;
  motion::Motion checked_;  // the download, once it is known to be valid; empty before
};

}  // namespace koboshi::app
