#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/object_server.h"

namespace koboshi::canopen {

// The object's end of an SDO transfer: a number, a text or a DOMAIN as so many bytes, whatever the protocol
// that carries them.
class SdoTransfer {
 public:
  explicit SdoTransfer(ObjectServer& objects) : objects_(objects) {}

  AbortCode begin_upload(ObjectAddress address);
  // Bytes of the object from `position` on; less than was asked for only at its end.
  std::size_t read(std::uint32_t position, std::span<std::uint8_t> bytes);
  // Of an upload; Domain::kUnknownSize when only its end will tell.
  std::uint32_t size() const { return size_; }
  // A number that an expedited response can carry; value().size() bytes of it.
  bool fits_expedited() const { return domain_ == nullptr && !value_.is_text() && size_ >= 1 && size_ <= 4; }
  const ObjectValue& value() const { return value_; }

  // `size` as announced, or Domain::kUnknownSize.
  AbortCode begin_download(ObjectAddress address, std::uint32_t size);
  AbortCode write(std::span<const std::uint8_t> bytes);
  // The object takes what was written; a number, if the client has not told its size, as many bytes of it as
  // the object has.
  AbortCode commit(bool size_told = true);

  // Ends the transfer. Nothing happens when there is none.
  void end();

  ObjectAddress address() const { return address_; }
  bool uses(const Domain& domain) const { return domain_ == &domain; }

 private:
  ObjectServer& objects_;
  ObjectAddress address_;
  Domain* domain_ = nullptr;
  ObjectValue value_;                     // of an upload
  std::array<std::uint8_t, 4> number_{};  // of a download
  std::uint32_t position_ = 0;            // bytes written so far
  std::uint32_t size_ = Domain::kUnknownSize;
};

}  // namespace koboshi::canopen
