#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/dictionary.h"

// The server's view of the objects that it reads and writes (CiA 301, 7.2.4).
namespace koboshi::canopen {

// The contents of an object of type DOMAIN (CiA 301, 7.4.5): any number of bytes, such as a motion in flash.
// An SDO server transfers them in pieces and buffers none. Each function refuses with the abort code that the
// client is to see; those that begin, write or commit may also return kBusy, have then done nothing, and are
// called again. Every transfer that has begun ends with `release`; no other begins before.
class Domain {
 public:
  static constexpr std::uint32_t kUnknownSize = ~std::uint32_t{0};

  // Begins an upload; sets the number of bytes, or leaves kUnknownSize.
  virtual AbortCode begin_upload(std::uint32_t& /*size_bytes*/) { return AbortCode::kReadOfWriteOnly; }
  // Copies the bytes from `position` on and returns their number, which is less than requested only at the
  // end. The position may go back by up to a block (889 bytes) when a client has lost segments.
  virtual std::size_t read(std::uint32_t /*position*/, std::span<std::uint8_t> /*bytes*/) { return 0; }

  // Begins a download of `size_bytes`, as the client indicates them, or kUnknownSize. No more bytes than
  // indicated are written.
  virtual AbortCode begin_download(std::uint32_t /*size_bytes*/) { return AbortCode::kWriteOfReadOnly; }
  // Writes the next 1..7 bytes.
  virtual AbortCode write(std::span<const std::uint8_t> /*bytes*/) { return AbortCode::kGeneralError; }
  // Completes a download: all bytes have arrived, as many as indicated, with the right CRC if the client
  // sends one. The bytes written must have no effect before.
  virtual AbortCode commit() { return AbortCode::kNone; }

  // Ends a transfer, completed or not.
  virtual void release() {}

 protected:
  ~Domain() = default;
};

// The dictionary behind an SDO server.
class ObjectServer {
 public:
  virtual AbortCode read_object(ObjectAddress address, ObjectValue& value) = 0;
  // `size` in bytes; 0: not indicated by the client, that of the object.
  virtual AbortCode write_object(ObjectAddress address, std::uint32_t value, std::size_t size) = 0;
  // Checks that the object exists, and sets `domain` to that of a DOMAIN, which may then be read or written
  // (`access`), or to null for objects of other types.
  virtual AbortCode open_domain(ObjectAddress address, Access access, Domain*& domain) = 0;

 protected:
  ~ObjectServer() = default;
};

}  // namespace koboshi::canopen
