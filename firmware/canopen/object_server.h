#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/canopen/abort_code.h"
#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/domain.h"

namespace koboshi::canopen {

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
