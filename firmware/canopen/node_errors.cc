// Errors: how they are told, and which the stack sees itself (CiA 301, 7.2.7 and table 26).

#include "firmware/canopen/node.h"

namespace koboshi::canopen {

void Node::raise_error(std::uint16_t code, std::uint8_t register_bits,
                       const std::array<std::uint8_t, 5>& manufacturer) {
  if (errors_.raise(code, register_bits, load_u16(manufacturer.data()))) send_emergency(code, manufacturer);
}

void Node::clear_error(std::uint16_t code) {
  if (errors_.clear(code)) send_emergency(error_code::kNoError, {});
}

void Node::report(std::uint16_t code, bool present, std::uint8_t detail) {
  constexpr auto kStack = ErrorReporter::kStack;
  if (present) {
    if (errors_.raise(code, error_register::kCommunication, detail, kStack)) send_emergency(code, {detail});
  } else if (errors_.clear(code, kStack)) {
    send_emergency(error_code::kNoError, {});
  }
}

void Node::send_emergency(std::uint16_t code, const std::array<std::uint8_t, 5>& manufacturer) {
  if (!permits_emergency(state_)) return;
  emergencies_.send({node_id_, code, errors_.error_register(), manufacturer});
}

void Node::on_can_status(const hal::CanStatus& status, std::uint64_t now_us) {
  using enum hal::CanErrorState;
  const hal::CanStatus before = can_status_;
  can_status_ = status;
  // What has happened is an error until the next call finds that it has not happened again.
  report(error_code::kCanOverrun, status.receive_overruns != before.receive_overruns);
  report(error_code::kBusOffRecovered, before.state == kBusOff && status.state != kBusOff);
  report(error_code::kCanErrorPassive, status.state != kErrorActive);
  if (status.state == kBusOff && before.state != kBusOff) on_communication_error(now_us);
}

void Node::note_reception(std::size_t number, Reception reception) {
  struct Fault {
    Reception reception;
    std::uint16_t code;
  };
  constexpr Fault kFaults[] = {{Reception::kTooShort, error_code::kPdoTooShort},
                               {Reception::kTooLong, error_code::kPdoTooLong},
                               {Reception::kTimedOut, error_code::kRpdoTimeout}};
  rpdos_[number].reception = reception;
  for (const Fault& fault : kFaults) {
    if (fault.reception == reception) report(fault.code, true, static_cast<std::uint8_t>(number + 1));
    if (!rpdos_.any(fault.reception)) report(fault.code, false);
  }
}

// Heartbeats have nearly the lowest priority of all: on a bus that is full of SDO messages they do not get
// through, whoever lives. So nobody is lost as long as this node's own do not get out either. One that has
// none to send beats early, before somebody would be lost, to find out. A node that is not acknowledged is
// error-passive: it learns nothing of the bus that way.
void Node::watch_own_beats(std::uint64_t now_us) {
  // On a bus with any room to spare, they leave within a cycle of its PDOs.
  constexpr std::uint64_t kStarved_us = 10'000;
  const bool wait =
      can_status_.state == hal::CanErrorState::kErrorActive && queue_.pending(hal::kBackgroundFifo);
  if (!wait) {
    beats_out_us_ = now_us;
    const bool may_beat = heartbeat_ms_ != 0 && now_us - beat_us_ >= kStarved_us;
    if (may_beat && heartbeats_.expects_by(now_us + 2 * kStarved_us)) beat(now_us);
  } else if (now_us - beats_out_us_ >= kStarved_us) {
    heartbeats_.postpone(now_us);
  }
}

void Node::watch_heartbeats(std::uint64_t now_us) {
  HeartbeatEvent event;
  while (heartbeats_.check(now_us, event)) {
    report(error_code::kHeartbeat, true, event.node_id);
    application_.on_heartbeat(event);
    on_communication_error(now_us);
  }
}

void Node::on_rpdo_changed(std::size_t number) {
  rpdos_.on_changed(number);
  note_reception(number, Reception::kRight);
}

void Node::watch_rpdos(std::uint64_t now_us) {
  std::size_t number = 0;
  while (rpdos_.check(now_us, number)) note_reception(number, Reception::kTimedOut);
}

void Node::on_communication_error(std::uint64_t now_us) {
  switch (communication_error_) {
    case CommunicationError::kEnterPreOperational:
      if (state_ == NmtState::kOperational) enter(NmtState::kPreOperational, now_us);
      return;
    case CommunicationError::kNoChange:
      return;
    case CommunicationError::kStop:
      return enter(NmtState::kStopped, now_us);
  }
}

}  // namespace koboshi::canopen
