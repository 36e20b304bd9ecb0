#include "firmware/canopen/heartbeat.h"

#include <algorithm>
#include <limits>

#include "firmware/canopen/frame.h"

namespace koboshi::canopen {

AbortCode HeartbeatMonitor::read(std::uint8_t subindex, ObjectValue& value) const {
  if (subindex > consumers_.size()) return AbortCode::kSubindexDoesNotExist;
  if (subindex == 0) {
    value.set_number(static_cast<std::uint32_t>(consumers_.size()), 1);
    return AbortCode::kNone;
  }
  const HeartbeatConsumer& consumer = consumers_[subindex - 1u];
  value.set_number((static_cast<std::uint32_t>(consumer.node_id) << 16) | consumer.time_ms, 4);
  return AbortCode::kNone;
}

AbortCode HeartbeatMonitor::write(std::uint8_t subindex, std::uint32_t value) {
  if (subindex > consumers_.size()) return AbortCode::kSubindexDoesNotExist;
  if (subindex == 0) return AbortCode::kWriteOfReadOnly;
  const std::uint32_t node_id = value >> 16;
  if (node_id > kMaxNodeId) return AbortCode::kInvalidValue;
  HeartbeatConsumer consumer{.node_id = static_cast<std::uint8_t>(node_id),
                             .time_ms = static_cast<std::uint16_t>(value)};
  const HeartbeatConsumer* same = find(consumer.node_id);
  // No node may have two consumers (CiA 301, object 0x1016).
  if (monitors(consumer) && same != nullptr && same != &consumers_[subindex - 1u]) {
    return AbortCode::kParameterIncompatibility;
  }
  consumers_[subindex - 1u] = consumer;
  update_slots();
  return AbortCode::kNone;
}

void HeartbeatMonitor::clear() {
  std::fill(consumers_.begin(), consumers_.end(), HeartbeatConsumer{});
  slots_.clear();
}

void HeartbeatMonitor::await(std::uint8_t node_id) {
  const std::size_t slot = slots_.find(node_id);
  if (slot != SlotMap::kNone) consumers_[slot].alive = false;
}

void HeartbeatMonitor::postpone(std::uint64_t now_us) {
  for (HeartbeatConsumer& consumer : consumers_)
    consumer.deadline_us = std::max(consumer.deadline_us, now_us + consumer.time_ms * 1000u);
}

std::uint64_t HeartbeatMonitor::find_earliest() {
  earliest_us_ = std::numeric_limits<std::uint64_t>::max();
  for (const HeartbeatConsumer& consumer : consumers_) {
    if (consumer.alive) earliest_us_ = std::min(earliest_us_, consumer.deadline_us);
  }
  return earliest_us_;
}

void HeartbeatMonitor::update_slots() {
  slots_.clear();
  for (std::size_t i = 0; i < consumers_.size(); ++i) {
    if (monitors(consumers_[i])) slots_.insert(consumers_[i].node_id, static_cast<std::uint8_t>(i));
  }
}

bool HeartbeatMonitor::on_heartbeat(const Heartbeat& heartbeat, std::uint64_t now_us, HeartbeatEvent& event) {
  const std::size_t slot = slots_.find(heartbeat.node_id);
  if (slot == SlotMap::kNone) return false;
  HeartbeatConsumer& consumer = consumers_[slot];
  const HeartbeatConsumer before = consumer;
  consumer.lost = false;
  consumer.state = heartbeat.state;
  const bool booted = heartbeat.state == NmtState::kInitialising;
  consumer.alive = before.alive || !booted;
  consumer.deadline_us = now_us + consumer.time_ms * 1000u;
  earliest_us_ = std::min(earliest_us_, consumer.deadline_us);

  event = {heartbeat.node_id, HeartbeatEventKind::kStateChanged, heartbeat.state};
  if (booted) {
    event.kind = HeartbeatEventKind::kBootedUp;
  } else if (!before.alive || before.state == NmtState::kInitialising) {
    event.kind = HeartbeatEventKind::kFirstSeen;
  }
  return event.kind != HeartbeatEventKind::kStateChanged || before.state != heartbeat.state;
}

bool HeartbeatMonitor::find_lost(std::uint64_t now_us, HeartbeatEvent& event) {
  for (HeartbeatConsumer& consumer : consumers_) {
    if (!consumer.alive || now_us < consumer.deadline_us) continue;
    consumer.alive = false;
    consumer.lost = true;
    event = {consumer.node_id, HeartbeatEventKind::kLost, consumer.state};
    return true;
  }
  find_earliest();
  return false;
}

bool HeartbeatMonitor::any_lost() const {
  return std::ranges::any_of(consumers_, [](const HeartbeatConsumer& consumer) { return consumer.lost; });
}

const HeartbeatConsumer* HeartbeatMonitor::find(std::uint8_t node_id) const {
  const std::size_t slot = slots_.find(node_id);
  return slot == SlotMap::kNone ? nullptr : &consumers_[slot];
}

}  // namespace koboshi::canopen
