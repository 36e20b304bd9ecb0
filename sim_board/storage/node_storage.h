#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/canopen/node/node.h"
#include "firmware/canopen/node/stored_parameters.h"
#include "firmware/storage/item_store.h"
#include "sim_board/state/archive.h"
#include "sim_board/storage/node_flash.h"

namespace koboshi::sim_board {

// Non-volatile data of a drive or sensor: its parameters (0x1010, 0x1011) and the node id assigned by LSS.
// The owner forwards the node's requests (canopen::NodeApplication).
class NodeStorage {
 public:
  // The node must outlive the storage.
  explicit NodeStorage(canopen::Node& node) : node_(node) { power_on(); }
  NodeStorage(const NodeStorage&) = delete;
  NodeStorage& operator=(const NodeStorage&) = delete;

  // Simulates a power failure: a write in progress is lost, and the old data stay valid.
  void power_on();
  // Returns the stored node id, or else the factory's.
  std::uint8_t node_id(std::uint8_t factory) const;

  canopen::AbortCode store(canopen::ParameterGroup group) { return volatile_->parameters.store(group); }
  canopen::AbortCode restore(canopen::ParameterGroup group) { return volatile_->parameters.restore(group); }
  canopen::AbortCode store_node_id(std::uint8_t node_id);
  // Restores the parameters that this reset restores. Call it from on_reset.
  void load(canopen::NmtCommand reset);
  // Call it once per millisecond.
  void process() {
    volatile_->items.process();
    volatile_->parameters.process();
  }

  void archive(StateArchive& archive);

 private:
  // The firmware's view of the flash, which a restart creates anew.
  struct Volatile {
    Volatile(NodeFlash& flash, canopen::Node& node)
        : items(flash, NodeFlash::kSize_bytes), parameters(items, node) {}

    storage::ItemStore items;
    canopen::StoredParameters parameters;
    bool node_id_begun = false;
    bool node_id_appended = false;
  };

  std::span<const std::byte> stored_node_id() const {
    return volatile_->items.find(storage::ItemKind::kNodeId, 0);
  }
  storage::Status write_node_id(std::uint8_t node_id);

  canopen::Node& node_;
  NodeFlash flash_;
  std::optional<Volatile> volatile_;
};

}  // namespace koboshi::sim_board
