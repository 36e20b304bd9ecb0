#include "firmware/storage/motion_transfer.h"

#include <algorithm>

#include "firmware/motion/motion.h"
#include "firmware/robot/image.h"

namespace koboshi::storage {

using canopen::AbortCode;

void MotionTransfer::select(std::uint16_t number, std::span<const std::byte> image, bool may_store) {
  if (activity_ != Activity::kNone) return;
  number_ = number;
  image_ = image;
  may_store_ = may_store;
}

AbortCode MotionTransfer::begin_upload(std::uint32_t& size_bytes) {
  if (image_.empty()) return AbortCode::kNoData;
  size_bytes = static_cast<std::uint32_t>(image_.size());
  activity_ = Activity::kUpload;
  return AbortCode::kNone;
}

std::size_t MotionTransfer::read(std::uint32_t position, std::span<std::uint8_t> bytes) {
  const auto rest = image_.subspan(std::min<std::size_t>(position, image_.size()));
  const auto piece = rest.first(std::min(rest.size(), bytes.size()));
  std::ranges::transform(piece, bytes.begin(), std::to_integer<std::uint8_t>);
  return piece.size();
}

AbortCode MotionTransfer::begin_download(std::uint32_t size_bytes) {
  if (!may_store_) return AbortCode::kDeviceState;
  // Nothing is erased for what cannot be a motion; all that an expedited transfer carries is too short.
  if (size_bytes < robot::kImageHeaderSize) return AbortCode::kLengthTooLow;
  if (size_bytes != kUnknownSize && size_bytes > ItemStore::kMaxItemSize) return AbortCode::kLengthTooHigh;
  const AbortCode begun = items_.begin(ItemKind::kMotion, number_);
  if (begun == AbortCode::kNone) activity_ = Activity::kDownload;
  checked_ = {};
  return begun;
}

AbortCode MotionTransfer::write(std::span<const std::uint8_t> bytes) {
  return items_.append(std::as_bytes(bytes));
}

AbortCode MotionTransfer::commit() {
  if (checked_.step_count() == 0) {
    const AbortCode flushed = items_.flush();
    if (flushed != AbortCode::kNone) return flushed;
    if (!motion::Motion::open(items_.written(), model_, checked_).ok()) return AbortCode::kInvalidValue;
  }
  const AbortCode committed = items_.commit();
  if (committed == AbortCode::kNone) motions_.add(number_, checked_);
  return committed;
}

void MotionTransfer::release() {
  if (activity_ == Activity::kDownload) items_.release();
  activity_ = Activity::kNone;
}

}  // namespace koboshi::storage
