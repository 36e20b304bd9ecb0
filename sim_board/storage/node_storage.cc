#include "sim_board/storage/node_storage.h"

#include <array>
#include <cstddef>
#include <span>

namespace koboshi::sim {

using canopen::AbortCode;

void NodeStorage::power_on() {
  flash_.lose_power();
  volatile_.emplace(flash_, node_);
}

std::uint8_t NodeStorage::node_id(std::uint8_t factory) const {
  const auto stored = volatile_->items.find(static_cast<std::uint16_t>(Item::kNodeId), 0);
  return stored.empty() ? factory : std::to_integer<std::uint8_t>(stored.front());
}

AbortCode NodeStorage::store_node_id(std::uint8_t node_id) {
  if (!volatile_->node_id_begun && this->node_id(node_id) == node_id &&
      !volatile_->items.find(static_cast<std::uint16_t>(Item::kNodeId), 0).empty()) {
    return AbortCode::kNone;
  }
  const AbortCode written = write_node_id(node_id);
  if (written == AbortCode::kBusy) return written;
  volatile_->items.release();
  volatile_->node_id_begun = false;
  volatile_->node_id_appended = false;
  return written;
}

AbortCode NodeStorage::write_node_id(std::uint8_t node_id) {
  canopen::ItemStore& items = volatile_->items;
  if (!volatile_->node_id_begun) {
    const AbortCode begun = items.begin(static_cast<std::uint16_t>(Item::kNodeId), 0);
    // Parameters are being written; their turn ends by itself.
    if (begun == AbortCode::kDeviceState) return AbortCode::kBusy;
    if (begun != AbortCode::kNone) return begun;
    volatile_->node_id_begun = true;
  }
  if (!volatile_->node_id_appended) {
    const AbortCode appended = items.append(std::array{std::byte{node_id}});
    if (appended != AbortCode::kNone) return appended;
    volatile_->node_id_appended = true;
  }
  return items.commit();
}

void NodeStorage::load(canopen::NmtCommand reset) {
  volatile_->parameters.load(reset == canopen::NmtCommand::kResetNode
                                 ? canopen::ParameterGroup::kAll
                                 : canopen::ParameterGroup::kCommunication);
}

void NodeStorage::process() {
  volatile_->items.process();
  volatile_->parameters.process();
}

}  // namespace koboshi::sim
