#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/canopen/abort_code.h"
#include "firmware/canopen/object.h"

namespace koboshi::canopen {

class Node;
class ObjectValue;

// One write of the sequence that makes a node that was just reset what it is now.
struct ParameterValue {
  ObjectAddress address;
  std::uint8_t size_bytes = 0;
  std::uint32_t value = 0;

  friend bool operator==(const ParameterValue&, const ParameterValue&) = default;
};

// Objects and parameters of services of CiA 301 and CiA 305 that not every node has. A node without them
// carries none of their code. Each call is from within one of the node's.
class NodeServices {
 public:
  // Their objects of the communication profile area. kObjectDoesNotExist for all others.
  virtual AbortCode read(ObjectAddress address, ObjectValue& value) const = 0;
  // Every write of an SDO client: theirs, or else Node::write_own. `size` in bytes; 0: as many as the object
  // has.
  virtual AbortCode write(Node& node, ObjectAddress address, std::uint32_t value, std::size_t size) = 0;
  // The node's communication parameters as writes, in the order in which they are to be made. Those that are
  // as after a reset and depend on the node id are left out. False past the last.
  virtual bool parameter(Node& node, std::size_t number, ParameterValue& parameter) const = 0;
  // One of them comes back from storage.
  virtual void restore(Node& node, const ParameterValue& parameter) = 0;

 protected:
  ~NodeServices() = default;
};

}  // namespace koboshi::canopen
