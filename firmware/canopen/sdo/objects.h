#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/dictionary.h"

// What stands behind an SDO server: the objects that it reads and writes.
namespace koboshi::canopen {

// What stands behind an object of type DOMAIN (CiA 301, 7.4.5): any number of bytes that its owner keeps, a
// motion in flash or a log. An SDO server moves them in pieces and buffers none of them; the owner refuses
// with the code that the client is to see, or says kBusy to what begins, writes or commits: it has done
// nothing and is asked again. Each transfer that has begun ends with `release`, whatever became of it;
// before, there is no second one.
class Domain {
 public:
  static constexpr std::uint32_t kUnknownSize = ~std::uint32_t{0};

  // Fills in how many bytes there are, or leaves kUnknownSize.
  virtual AbortCode begin_upload(std::uint32_t& /*size_bytes*/) { return AbortCode::kReadOfWriteOnly; }
  // Copies the bytes from `position` on and returns their number, less than was asked for only at the end.
  // The position may go back by up to a block (889 bytes) when a client has lost segments.
  virtual std::size_t read(std::uint32_t /*position*/, std::span<std::uint8_t> /*bytes*/) { return 0; }

  // `size_bytes` as the client announces it, or kUnknownSize. More than announced never arrives.
  virtual AbortCode begin_download(std::uint32_t /*size_bytes*/) { return AbortCode::kWriteOfReadOnly; }
  // The next 1..7 bytes.
  virtual AbortCode write(std::span<const std::uint8_t> /*bytes*/) { return AbortCode::kGeneralError; }
  // All bytes have arrived, as many as announced and with the right CRC if the client sends one. Nothing that
  // was written may count before.
  virtual AbortCode commit() { return AbortCode::kNone; }

  virtual void release() {}

 protected:
  ~Domain() = default;
};

// The objects behind an SDO server.
class ObjectServer {
 public:
  virtual AbortCode read_object(ObjectAddress address, ObjectValue& value) = 0;
  // `size` in bytes; 0 when the client has not told it and the object's own counts.
  virtual AbortCode write_object(ObjectAddress address, std::uint32_t value, std::size_t size) = 0;
  // Whether there is such an object, and if it is a DOMAIN that may be read or written (`access`) now, which;
  // null for any other type.
  virtual AbortCode open_domain(ObjectAddress address, Access access, Domain*& domain) = 0;

 protected:
  ~ObjectServer() = default;
};

}  // namespace koboshi::canopen
