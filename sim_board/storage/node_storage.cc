#include "sim_board/storage/node_storage.h"

#include <array>
#include <cstddef>

namespace koboshi::sim_board {

using canopen::AbortCode;
using storage::Status;

void NodeStorage::power_on() {
  flash_.lose_power();
  volatile_.emplace(flash_, node_);
}

std::uint8_t NodeStorage::node_id(std::uint8_t factory) const {
  const auto stored = stored_node_id();
  return stored.empty() ? factory : std::to_integer<std::uint8_t>(stored.front());
}

AbortCode NodeStorage::store_node_id(std::uint8_t node_id) {
  const auto stored = stored_node_id();
  if (!volatile_->node_id_begun && !stored.empty() && stored.front() == std::byte{node_id})
    return AbortCode::kNone;
  const Status written = write_node_id(node_id);
  if (written == Status::kBusy) return AbortCode::kBusy;
  volatile_->items.release();
  volatile_->node_id_begun = false;
  volatile_->node_id_appended = false;
  return canopen::abort_code_of(written);
}

Status NodeStorage::write_node_id(std::uint8_t node_id) {
  storage::ItemStore& items = volatile_->items;
  if (!volatile_->node_id_begun) {
    const Status begun = items.begin(storage::ItemKind::kNodeId, 0, 1);
    // A write of parameters is in progress and will end.
    if (begun == Status::kInUse) return Status::kBusy;
    if (begun != Status::kOk) return begun;
    volatile_->node_id_begun = true;
  }
  if (!volatile_->node_id_appended) {
    const Status appended = items.append(std::array{std::byte{node_id}});
    if (appended != Status::kOk) return appended;
    volatile_->node_id_appended = true;
  }
  return items.commit();
}

void NodeStorage::load(canopen::NmtCommand reset) {
  volatile_->parameters.load(reset == canopen::NmtCommand::kResetNode
                                 ? canopen::ParameterGroup::kAll
                                 : canopen::ParameterGroup::kCommunication);
}

void NodeStorage::archive(StateArchive& archive) {
  archive(flash_);
  archive.in_place(*volatile_);
}

}  // namespace koboshi::sim_board
