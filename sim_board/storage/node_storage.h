#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/canopen/node.h"
#include "firmware/canopen/stored_parameters.h"
#include "firmware/storage/item_store.h"
#include "sim_board/state/archive.h"
#include "sim_board/storage/node_flash.h"

namespace koboshi::sim {

// What a drive or sensor keeps while it has no power: its parameters (0x1010, 0x1011) and the node id that
// LSS has given it. The owner passes on what its node asks for (canopen::NodeApplication).
class NodeStorage {
 public:
  // The node must outlive the storage.
  explicit NodeStorage(canopen::Node& node) : node_(node) { power_on(); }
  NodeStorage(const NodeStorage&) = delete;
  NodeStorage& operator=(const NodeStorage&) = delete;

  // Power fails and comes back: what was being written is lost, and what was there before holds.
  void power_on();
  // The stored node id, else the factory's.
  std::uint8_t node_id(std::uint8_t factory) const;

  canopen::AbortCode store(canopen::ParameterGroup group) { return volatile_->parameters.store(group); }
  canopen::AbortCode restore(canopen::ParameterGroup group) { return volatile_->parameters.restore(group); }
  canopen::AbortCode store_node_id(std::uint8_t node_id);
  // From within on_reset: the parameters that this reset brings back.
  void load(canopen::NmtCommand reset);
  // Once a millisecond.
  void process();

  void archive(StateArchive& archive) {
    archive(flash_);
    archive.in_place(*volatile_);
  }

 private:
  static constexpr storage::ItemStore::Layout kLayout{NodeFlash::kSectorSize_bytes, NodeFlash::kSectors};

  // The firmware's view of the flash, which a restart makes anew.
  struct Volatile {
    Volatile(NodeFlash& flash, canopen::Node& node) : items(flash, kLayout), parameters(items, node) {}

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

}  // namespace koboshi::sim
