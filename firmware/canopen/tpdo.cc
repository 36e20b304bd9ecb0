#include "firmware/canopen/tpdo.h"

#include <algorithm>
#include <limits>

namespace koboshi::canopen {

bool TpdoSet::sends(std::uint16_t identifier) const {
  return std::ranges::any_of(pdos_, [identifier](const Tpdo& pdo) {
    return pdo.record.valid() && pdo.record.identifier() == identifier;
  });
}

void TpdoSet::on_changed(std::size_t number) {
  const PdoRecord& changed = pdos_[number].record;
  pdos_[number].watched = number < watched_ && changed.valid() && changed.tells_changes();
  forget(pdos_[number]);
  due_us_ = 0;
  synchronous_end_ = 0;
  watched_end_ = 0;
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    if (pdos_[i].record.valid() && pdos_[i].record.synchronous()) synchronous_end_ = i + 1;
    if (pdos_[i].watched) watched_end_ = i + 1;
  }
}

void TpdoSet::forget(Tpdo& pdo) {
  pdo.requested = pdo.watched;
  pdo.counting = false;
  pdo.sync_count = 0;
}

void TpdoSet::start(std::uint64_t now_us) {
  due_us_ = 0;
  for (Tpdo& pdo : pdos_) {
    forget(pdo);
    pdo.event_due_us = now_us + pdo.record.event_timer_us();
  }
}

void TpdoSet::watch() {
  for (Tpdo& pdo : pdos_.first(watched_end_)) {
    if (!pdo.watched) continue;
    std::array<std::uint8_t, 8> data{};
    pdo.record.pack(dictionary_, data.data());
    if (data == pdo.seen) continue;
    pdo.seen = data;
    pdo.requested = true;
    due_us_ = 0;
  }
}

void TpdoSet::request(std::size_t number, std::uint64_t now_us) {
  Tpdo& pdo = pdos_[number];
  if (!pdo.record.valid()) return;
  pdo.requested = true;
  if (!pdo.record.synchronous() && now_us >= pdo.inhibited_until_us) send(pdo, now_us);
  if (pdo.requested) due_us_ = 0;
}

void TpdoSet::on_sync(std::uint8_t counter, std::uint64_t now_us) {
  if (watched_end_ != 0) watch();
  for (Tpdo& pdo : pdos_.first(synchronous_end_)) {
    if (pdo.record.valid() && pdo.record.synchronous() && is_due(pdo, counter)) send(pdo, now_us);
  }
}

bool TpdoSet::is_due(Tpdo& pdo, std::uint8_t counter) {
  const std::uint8_t type = pdo.record.transmission_type();
  if (type == kSynchronousAcyclic) return pdo.requested;
  // A start value needs a counter; the SYNC that has it is the first (CiA 301, 7.5.2.37).
  const std::uint8_t start = counter != 0 ? pdo.record.sync_start() : std::uint8_t{0};
  if (!pdo.counting && start != 0 && counter != start) return false;
  pdo.counting = true;
  return ++pdo.sync_count >= type;
}

void TpdoSet::send_due(std::uint64_t now_us) {
  due_us_ = std::numeric_limits<std::uint64_t>::max();
  for (Tpdo& pdo : pdos_) {
    if (!pdo.record.valid() || pdo.record.synchronous()) continue;
    const bool timed = pdo.record.event_timer_us() != 0;
    if (timed && now_us >= pdo.event_due_us) pdo.requested = true;
    if (pdo.requested && now_us >= pdo.inhibited_until_us) send(pdo, now_us);
    if (pdo.requested) due_us_ = std::min(due_us_, pdo.inhibited_until_us);
    if (timed) due_us_ = std::min(due_us_, pdo.event_due_us);
  }
}

void TpdoSet::send(Tpdo& pdo, std::uint64_t now_us) {
  hal::CanFrame frame{.identifier = pdo.record.identifier(), .size = pdo.record.size_bytes()};
  pdo.record.pack(dictionary_, frame.data.data());
  pdo.sync_count = 0;
  pdo.requested = !queue_.send(frame);
  if (pdo.requested || pdo.record.untimed()) return;
  pdo.inhibited_until_us = now_us + pdo.record.inhibit_time_us();
  pdo.event_due_us = now_us + pdo.record.event_timer_us();
}

}  // namespace koboshi::canopen
