#include "firmware/canopen/tpdo.h"

#include <algorithm>
#include <limits>

namespace koboshi::canopen {

void TpdoSet::start(std::uint64_t now_us) {
  due_us_ = 0;
  for (Tpdo& pdo : pdos_) {
    pdo.requested = false;
    pdo.sync_count = 0;
    pdo.event_due_us = now_us + pdo.record.event_timer_us();
  }
}

void TpdoSet::request(std::size_t number, std::uint64_t now_us) {
  Tpdo& pdo = pdos_[number];
  if (!pdo.record.valid()) return;
  pdo.requested = true;
  if (!pdo.record.synchronous() && now_us >= pdo.inhibited_until_us) send(pdo, now_us);
  if (pdo.requested) due_us_ = 0;
}

void TpdoSet::on_sync(std::uint64_t now_us) {
  for (Tpdo& pdo : pdos_) {
    if (!pdo.record.valid() || !pdo.record.synchronous()) continue;
    const std::uint8_t type = pdo.record.transmission_type();
    const bool due = type == kSynchronousAcyclic ? pdo.requested : ++pdo.sync_count >= type;
    if (due) send(pdo, now_us);
  }
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
