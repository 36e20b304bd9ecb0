#include "firmware/canopen/node/node.h"

#include <utility>

#include "firmware/canopen/frame.h"
#include "firmware/canopen/sync.h"

namespace koboshi::canopen {

Node::Node(const NodeDescription& description, const NodeInstance& instance, NodeBuffers buffers,
           FrameSink& sink, NodeApplication& application)
    : description_(description),
      node_id_(instance.node_id),
      serial_number_(instance.serial_number),
      dictionary_(description.rows, instance.values),
      application_(application),
      services_(instance.services),
      queue_(sink, buffers.backlog),
      servers_{SdoServer(*this, queue_), SdoServer(*this, queue_)},
      heartbeats_(buffers.consumers, buffers.consumer_slots),
      rpdos_(buffers.rpdos, buffers.rpdo_slots),
      tpdos_(buffers.tpdos, description.watched_tpdos, dictionary_, queue_),
      emergencies_(queue_) {}

void Node::start(std::uint64_t now_us) { reset(NmtCommand::kResetNode, now_us); }

void Node::on_frame(const hal::CanFrame& frame, std::uint64_t now_us) {
  // Remote frames request node guarding or a PDO; CiA AN 802 advises against both.
  if (frame.remote || state_ == NmtState::kInitialising) return;
  // Most frames are PDOs for this node; between these identifiers lie only PDOs.
  const bool pdo = frame.identifier >= kTpdo1Base && frame.identifier < kSdoResponseBase;
  if (pdo && take_pdo(frame, now_us)) return;
  if (sync_.identifies(frame)) {
    if (sync_.produces()) application_.on_impostor(frame.identifier);
    return on_sync(frame, now_us);
  }
  for (SdoServer& server : servers_) {
    if (!server.takes(frame)) continue;
    if (permits_sdo(state_)) server.on_request(frame, now_us);
    return;
  }
  // An identifier outside the bounds may be a PDO's too.
  if (!pdo && (serve(frame, now_us) || take_pdo(frame, now_us))) return;
  if (tpdos_.sends(frame.identifier)) application_.on_impostor(frame.identifier);
}

// False when the frame is no PDO that the node receives now.
bool Node::take_pdo(const hal::CanFrame& frame, std::uint64_t now_us) {
  if (!permits_pdo(state_)) return false;
  const std::size_t number = rpdos_.find(frame.identifier);
  if (number == SlotMap::kNone) return false;
  on_rpdo(number, frame, now_us);
  return true;
}

bool Node::serve(const hal::CanFrame& frame, std::uint64_t now_us) {
  if (frame.identifier == kNmtCobId) {
    on_nmt(frame, now_us);
    return true;
  }
  if (const auto heartbeat = decode_heartbeat(frame)) {
    on_heartbeat(*heartbeat, now_us);
    return true;
  }
  if (const auto emergency = decode_emergency(frame)) {
    if (emergency->node_id == node_id_) application_.on_impostor(frame.identifier);
    application_.on_emergency(*emergency);
    return true;
  }
  return false;
}

void Node::process(std::uint64_t now_us) {
  queue_.flush();
  if (state_ == NmtState::kInitialising) return;
  if (now_us >= heartbeat_due_us_) produce_heartbeat(now_us);
  watch_own_beats(now_us);
  if (heartbeats_.due(now_us)) watch_heartbeats(now_us);
  if (rpdos_.due(now_us)) watch_rpdos(now_us);
  if (permits_sync(state_) && sync_.take_due(now_us)) send_sync(now_us);
  if (permits_pdo(state_)) tpdos_.process(now_us);
  emergencies_.process(now_us);
  for (SdoServer& server : servers_) server.process(now_us);
}

void Node::command(NmtCommand command, std::uint64_t now_us) {
  switch (command) {
    case NmtCommand::kStart:
      return enter(NmtState::kOperational, now_us);
    case NmtCommand::kStop:
      return enter(NmtState::kStopped, now_us);
    case NmtCommand::kEnterPreOperational:
      return enter(NmtState::kPreOperational, now_us);
    case NmtCommand::kResetNode:
    case NmtCommand::kResetCommunication:
      return reset(command, now_us);
  }
}

void Node::enter(NmtState state, std::uint64_t now_us) {
  if (state == state_) return;
  const bool resumes_sync = !permits_sync(state_) && permits_sync(state);
  state_ = state;
  rpdos_.stop();
  if (resumes_sync) sync_.start(now_us);
  if (permits_pdo(state)) tpdos_.start(now_us);
  if (!permits_emergency(state)) emergencies_.clear();
  if (!permits_sdo(state)) {
    for (SdoServer& server : servers_) server.reset();
  }
  application_.on_state(state);
}

void Node::reset(NmtCommand reset, std::uint64_t now_us) {
  enter(NmtState::kInitialising, now_us);
  if (reset == NmtCommand::kResetNode) {
    errors_ = ErrorLog();
    can_status_ = {.receive_overruns = can_status_.receive_overruns};
  }
  if (services_ != nullptr) services_->on_reset(*this, reset);
  load_defaults();
  application_.on_reset(reset);
  if (node_id_ == kUnconfiguredNodeId) return;
  heartbeat_due_us_ = now_us + heartbeat_ms_ * 1000u;
  static_cast<void>(queue_.send(encode(Heartbeat{node_id_, NmtState::kInitialising})));
  enter(NmtState::kPreOperational, now_us);
  if (application_.starts_itself()) enter(NmtState::kOperational, now_us);
}

void Node::load_defaults() {
  ++configuration_;
  heartbeat_ms_ = description_.heartbeat_ms;
  communication_error_ = description_.communication_error;
  sync_.load_defaults(description_.sync_producer, description_.sync_period_us, description_.sync_by_owner);
  emergencies_.load_defaults(node_id_);
  servers_[0].configure({static_cast<std::uint32_t>(kSdoRequestBase + node_id_),
                         static_cast<std::uint32_t>(kSdoResponseBase + node_id_)});
  servers_[1].configure(second_sdo());
  second_client_ = 0;
  heartbeats_.clear();
  report(error_code::kHeartbeat, false);
  bool possible = true;
  for (std::size_t i = 0; i < rpdos_.size(); ++i)
    possible &= configure_rpdo(i, default_pdo(PdoDirection::kReceive, i)) == AbortCode::kNone;
  for (std::size_t i = 0; i < tpdos_.size(); ++i)
    possible &= configure_tpdo(i, default_pdo(PdoDirection::kTransmit, i)) == AbortCode::kNone;
  for (std::size_t i = 0; i < heartbeats_.size(); ++i) {
    const std::uint32_t consumer = application_.default_consumer(i);
    if (consumer == 0) continue;
    possible &= heartbeats_.write(static_cast<std::uint8_t>(i + 1), consumer) == AbortCode::kNone;
  }
  if (!possible) raise_error(error_code::kDataSet, error_register::kManufacturer);
}

PdoConfiguration Node::default_pdo(PdoDirection direction, std::size_t number) const {
  const auto described = direction == PdoDirection::kReceive ? description_.rpdos : description_.tpdos;
  return number < described.size() ? described[number] : application_.default_pdo(direction, number);
}

SdoChannel Node::second_sdo() const {
  SdoChannel second = description_.second_sdo;
  if (second.plus_node_id) {
    second.request_cob_id += node_id_;
    second.response_cob_id += node_id_;
  }
  return second;
}

AbortCode Node::configure_rpdo(std::size_t number, const PdoConfiguration& configuration) {
  if (number >= rpdos_.size()) return AbortCode::kObjectDoesNotExist;
  ++configuration_;
  const AbortCode configured = rpdos_[number].record.configure(configuration, node_id_, dictionary_);
  on_rpdo_changed(number);
  return configured;
}

AbortCode Node::configure_tpdo(std::size_t number, const PdoConfiguration& configuration) {
  if (number >= tpdos_.size()) return AbortCode::kObjectDoesNotExist;
  const AbortCode configured = tpdos_[number].record.configure(configuration, node_id_, dictionary_);
  tpdos_.on_configured(number);
  return configured;
}

AbortCode Node::configure_consumer(std::size_t number, std::uint8_t node_id, std::uint16_t time_ms) {
  ++configuration_;
  return write_consumer(static_cast<std::uint8_t>(number + 1), std::uint32_t{node_id} << 16 | time_ms);
}

void Node::on_nmt(const hal::CanFrame& frame, std::uint64_t now_us) {
  const auto message = decode_nmt(frame);
  if (!message || (message->node_id != 0 && message->node_id != node_id_)) return;
  command(message->command, now_us);
}

void Node::on_sync(const hal::CanFrame& frame, std::uint64_t now_us) {
  if (!permits_sync(state_)) return;
  const bool expected = sync_.accept(frame, now_us);
  report(error_code::kSyncLength, !expected, frame.size);
  if (!expected) return;
  for (std::size_t i = 0; rpdo_pending_ && i < rpdos_.size(); ++i) {
    if (rpdos_[i].pending) take_effect(i, rpdos_[i], rpdos_[i].data);
  }
  rpdo_pending_ = false;
  application_.on_sync(now_us);
  if (permits_pdo(state_)) tpdos_.on_sync(sync_.counter(), now_us);
}

void Node::on_heartbeat(const Heartbeat& heartbeat, std::uint64_t now_us) {
  if (heartbeat.node_id == node_id_) application_.on_impostor(kHeartbeatBase + node_id_);
  HeartbeatEvent event;
  if (!heartbeats_.on_heartbeat(heartbeat, now_us, event)) return;
  application_.on_heartbeat(event);
  if (!heartbeats_.any_lost()) report(error_code::kHeartbeat, false);
}

void Node::on_rpdo(std::size_t number, const hal::CanFrame& frame, std::uint64_t now_us) {
  Rpdo& pdo = rpdos_[number];
  const std::uint8_t expected = pdo.record.size_bytes();
  const Reception reception = frame.size == expected  ? Reception::kRight
                              : frame.size < expected ? Reception::kTooShort
                                                      : Reception::kTooLong;
  if (reception != pdo.reception) note_reception(number, reception);
  if (reception == Reception::kTooShort) return;
  rpdos_.restart_timer(pdo, now_us);
  if (!pdo.record.synchronous()) return take_effect(number, pdo, frame.data);
  if (!sync_.window_open(now_us)) return;
  pdo.data = frame.data;
  pdo.pending = true;
  rpdo_pending_ = true;
}

void Node::take_effect(std::size_t number, Rpdo& pdo, const std::array<std::uint8_t, 8>& data) {
  pdo.pending = false;
  std::uint8_t refused = pdo.record.unpack(dictionary_, data.data());
  if (!application_.on_rpdo(number)) refused = pdo.record.mapped_mask();
  if (refused != pdo.refused) note_refusal(number, refused);
}

void Node::send_sync(std::uint64_t now_us) {
  if (!permits_sync(state_) || !sync_.produces()) return;
  const hal::CanFrame frame = sync_.next();
  static_cast<void>(queue_.send(frame));
  on_sync(frame, now_us);
}

void Node::produce_heartbeat(std::uint64_t now_us) {
  // A heartbeat that still waits in the queue is enough.
  if (heartbeat_ms_ == 0 || queue_.pending(hal::kBackgroundFifo)) return;
  beat(now_us);
  heartbeat_due_us_ = next_beat(heartbeat_due_us_, heartbeat_ms_ * 1000u, now_us);
}

void Node::beat(std::uint64_t now_us) {
  static_cast<void>(queue_.offer(encode(Heartbeat{node_id_, state_})));
  beat_us_ = now_us;
}

// --- Errors: how they are reported, and those that the stack itself detects (CiA 301, 7.2.7 and table 26)

void Node::raise_error(std::uint16_t code, std::uint8_t register_bits,
                       const std::array<std::uint8_t, 5>& manufacturer) {
  if (errors_.raise(code, register_bits, load_u16(manufacturer.data()))) send_emergency(code, manufacturer);
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

// A status like the last one is taken once: then no overrun and no recovery is left to report.
void Node::take_can_status(const hal::CanStatus& status, std::uint64_t now_us) {
  using enum hal::CanErrorState;
  const hal::CanStatus before = can_status_;
  can_status_ = status;
  can_status_changed_ = status != before;
  // An overrun or a recovery is an error until a call finds that it has not happened again.
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

// Each object that is refused anew is an event of its own, although the error is present already: at most
// kMaxMappedObjects messages for a PDO, and none for the next one with the same fault.
void Node::note_refusal(std::size_t number, std::uint8_t refused) {
  const unsigned before = std::exchange(rpdos_[number].refused, refused);
  if (refused == 0 && !rpdos_.any_refused()) report(error_code::kParameter, false);
  for (std::size_t i = 0; i < kMaxMappedObjects; ++i) {
    if ((refused & ~before & (1u << i)) == 0) continue;
    const ObjectAddress object = rpdos_[number].record.mapped_address(i);
    if (!errors_.raise(error_code::kParameter, 0, object.index, ErrorReporter::kStack))
      errors_.record(error_code::kParameter, object.index);
    send_emergency(error_code::kParameter,
                   {static_cast<std::uint8_t>(object.index), static_cast<std::uint8_t>(object.index >> 8),
                    object.subindex, static_cast<std::uint8_t>(number + 1)});
  }
}

// Heartbeats have nearly the lowest priority: on a bus that is full of SDO messages none gets through. So no
// node counts as lost while this node's own heartbeats do not get through either. If none of its own is due,
// the node sends one early, before another node would count as lost, to find out. An error-passive node
// learns nothing that way: nobody acknowledges its frames.
void Node::watch_own_beats(std::uint64_t now_us) {
  // On a bus that is not full they leave within a cycle of its PDOs, which is 10 ms.
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
  note_refusal(number, 0);
}

void Node::restart_rpdo_timer(std::size_t number, std::uint64_t now_us) {
  Rpdo& pdo = rpdos_[number];
  if (pdo.reception == Reception::kTimedOut) note_reception(number, Reception::kRight);
  rpdos_.restart_timer(pdo, now_us);
}

void Node::watch_rpdos(std::uint64_t now_us) {
  std::size_t number = 0;
  while (rpdos_.check(now_us, number)) {
    if (application_.on_rpdo_timeout(number)) note_reception(number, Reception::kTimedOut);
  }
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
