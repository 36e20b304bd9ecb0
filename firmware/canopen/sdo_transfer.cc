#include "firmware/canopen/sdo_transfer.h"

#include <algorithm>

#include "firmware/canopen/frame.h"

namespace koboshi::canopen {

AbortCode SdoTransfer::begin_upload(ObjectAddress address) {
  end();
  address_ = address;
  size_ = Domain::kUnknownSize;
  Domain* domain = nullptr;
  const AbortCode opened = objects_.open_domain(address, Access::kReadOnly, domain);
  if (opened != AbortCode::kNone) return opened;
  const AbortCode begun =
      domain != nullptr ? domain->begin_upload(size_) : objects_.read_object(address, value_);
  if (begun != AbortCode::kNone) return begun;
  domain_ = domain;
  if (domain == nullptr) size_ = value_.size();
  return AbortCode::kNone;
}

std::size_t SdoTransfer::read(std::uint32_t position, std::span<std::uint8_t> bytes) {
  if (domain_ != nullptr) return std::min(domain_->read(position, bytes), bytes.size());
  const auto all = value_.bytes();
  const auto rest = all.subspan(std::min<std::size_t>(position, all.size()));
  const std::size_t size = std::min(rest.size(), bytes.size());
  std::copy_n(rest.begin(), size, bytes.begin());
  return size;
}

AbortCode SdoTransfer::begin_download(ObjectAddress address, std::uint32_t size) {
  end();
  address_ = address;
  size_ = size;
  position_ = 0;
  number_ = {};
  Domain* domain = nullptr;
  const AbortCode opened = objects_.open_domain(address, Access::kWriteOnly, domain);
  if (opened != AbortCode::kNone) return opened;
  if (domain != nullptr) {
    const AbortCode begun = domain->begin_download(size);
    if (begun == AbortCode::kNone) domain_ = domain;
    return begun;
  }
  // Longer than any number: the attempt names the first thing that is wrong with it.
  const bool too_long = size != Domain::kUnknownSize && size > number_.size();
  return too_long ? objects_.write_object(address, 0, size) : AbortCode::kNone;
}

AbortCode SdoTransfer::write(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > size_ - position_) return AbortCode::kLengthMismatch;
  if (bytes.empty()) return AbortCode::kNone;
  if (domain_ == nullptr) {
    if (position_ + bytes.size() > number_.size()) return AbortCode::kLengthTooHigh;
    std::copy(bytes.begin(), bytes.end(), number_.begin() + static_cast<std::ptrdiff_t>(position_));
  }
  const AbortCode written = domain_ != nullptr ? domain_->write(bytes) : AbortCode::kNone;
  if (written == AbortCode::kNone) position_ += static_cast<std::uint32_t>(bytes.size());
  return written;
}

AbortCode SdoTransfer::commit(bool size_told) {
  if (size_ != Domain::kUnknownSize && position_ != size_) return AbortCode::kLengthMismatch;
  if (domain_ != nullptr) return domain_->commit();
  if (position_ == 0) return AbortCode::kLengthTooLow;
  return objects_.write_object(address_, load_u32(number_.data()), size_told ? position_ : 0);
}

void SdoTransfer::end() {
  Domain* const domain = domain_;
  domain_ = nullptr;
  if (domain != nullptr) domain->release();
}

}  // namespace koboshi::canopen
