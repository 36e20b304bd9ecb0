#pragma once

#include <cstdint>
#include <span>

#include "firmware/canopen/sdo/objects.h"
#include "firmware/storage/item_store.h"

namespace koboshi::app {

// Transfers an image between an SDO client and storage, one at a time: what the DOMAINs of motions and of the
// policy share. A download goes straight into the log, and counts only once it is complete and valid for this
// robot. An image that is being uploaded stays in place until then.
class ItemTransfer : public canopen::Domain {
 public:
  canopen::AbortCode begin_upload(std::uint32_t& size_bytes) final;
  std::size_t read(std::uint32_t position, std::span<std::uint8_t> bytes) final;
  canopen::AbortCode begin_download(std::uint32_t size_bytes) final;
  canopen::AbortCode write(std::span<const std::uint8_t> bytes) final;
  void release() final;

 protected:
  // The store must outlive the transfer.
  ItemTransfer(storage::ItemStore& items, storage::ItemKind kind) : items_(items), kind_(kind) {}
  ~ItemTransfer() = default;

  [[nodiscard]] bool is_under_way() const { return activity_ != Activity::kNone; }
  // Selects the item of the next transfer, with its present image, and whether a client may replace it.
  void select_item(std::uint16_t number, std::span<const std::byte> image, bool may_store) {
    number_ = number;
    image_ = image;
    may_store_ = may_store;
  }

  storage::ItemStore& items_;
  std::uint16_t number_ = 0;
  bool checked_ = false;  // the download is complete and valid

 private:
  enum class Activity : std::uint8_t { kNone, kUpload, kDownload };

  const storage::ItemKind kind_;
  std::span<const std::byte> image_;  // of the selected item; empty: there is none
  bool may_store_ = false;
  Activity activity_ = Activity::kNone;
};

}  // namespace koboshi::app
