#include "bus/dictionary/object_names.h"

#include <memory>

#include "bus/dictionary/node_kinds.h"
#include "firmware/drive/configuration.h"
#include "sim_board/sensor/sensor_node.h"

namespace koboshi::bus {
namespace {

struct Kinds {
  NodeKind controller = controller_kind();
  NodeKind drive = drive_kind();
  NodeKind inertial = inertial_kind();
  NodeKind ankle = ankle_kind();

  const NodeKind& of(int node) const {
    switch (node) {
      case drive::kControllerNodeId:
        return controller;
      case sim_board::kInertialNode:
        return inertial;
      case sim_board::kLeftAnkleNode:
      case sim_board::kRightAnkleNode:
        return ankle;
      default:
        return drive;
    }
  }
};

}  // namespace

std::function<std::string(int node, canopen::ObjectAddress address)> object_names() {
  return [kinds = std::make_shared<const Kinds>()](int node, canopen::ObjectAddress address) {
    const ObjectItem* const item = kinds->of(node).find(address);
    return item == nullptr ? std::string() : item->name;
  };
}

}  // namespace koboshi::bus
