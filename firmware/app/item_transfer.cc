#include "firmware/app/item_transfer.h"

#include <algorithm>

#include "firmware/canopen/node/stored_parameters.h"
#include "firmware/storage/image.h"

namespace koboshi::app {

using canopen::abort_code_of;
using canopen::AbortCode;

AbortCode ItemTransfer::begin_upload(std::uint32_t& size_bytes) {
  if (image_.empty()) return AbortCode::kNoData;
  size_bytes = static_cast<std::uint32_t>(image_.size());
  activity_ = Activity::kUpload;
  items_.pin(storage::Holder::kTransfer, image_);
  return AbortCode::kNone;
}

std::size_t ItemTransfer::read(std::uint32_t position, std::span<std::uint8_t> bytes) {
  const auto rest = image_.subspan(std::min<std::size_t>(position, image_.size()));
  const auto piece = rest.first(std::min(rest.size(), bytes.size()));
  std::ranges::transform(piece, bytes.begin(),
                         [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
  return piece.size();
}

AbortCode ItemTransfer::begin_download(std::uint32_t size_bytes) {
  if (!may_store_) return AbortCode::kDeviceState;
  // Refused before flash is erased; so is every expedited transfer.
  if (size_bytes < storage::kImageHeaderSize) return AbortCode::kLengthTooLow;
  const std::size_t size = size_bytes == kUnknownSize ? storage::ItemStore::kMaxItemSize_bytes : size_bytes;
  const AbortCode begun = abort_code_of(items_.begin(kind_, number_, size));
  if (begun == AbortCode::kNone) activity_ = Activity::kDownload;
  checked_ = false;
  return begun;
}

AbortCode ItemTransfer::write(std::span<const std::uint8_t> bytes) {
  return abort_code_of(items_.append(std::as_bytes(bytes)));
}

void ItemTransfer::release() {
  if (activity_ == Activity::kDownload) items_.release();
  if (activity_ == Activity::kUpload) items_.unpin(storage::Holder::kTransfer);
  activity_ = Activity::kNone;
}

}  // namespace koboshi::app
