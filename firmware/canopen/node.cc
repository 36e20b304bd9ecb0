#include "firmware/canopen/node.h"

#include "firmware/canopen/cob_id.h"

namespace koboshi::canopen {
namespace {

// When a beat that was due at `due_us` is due next. Late by a period and more, it starts anew instead of
// catching up.
std::uint64_t next_beat(std::uint64_t due_us, std::uint64_t period_us, std::uint64_t now_us) {
  const std::uint64_t next_us = due_us + period_us;
  return next_us > now_us ? next_us : now_us + period_us;
}

}  // namespace

Node::Node(const NodeDescription& description, const NodeInstance& instance, NodeBuffers buffers,
           FrameSink& sink, NodeApplication& application)
    : description_(description),
      node_id_(instance.node_id),
      serial_number_(instance.serial_number),
      dictionary_(description.rows, instance.values),
      application_(application),
      queue_(sink, buffers.backlog),
      server_(static_cast<std::uint16_t>(kSdoRequestBase + node_id_),
              static_cast<std::uint16_t>(kSdoResponseBase + node_id_)),
      heartbeats_(buffers.consumers, buffers.consumer_slots),
      rpdos_(buffers.rpdos, buffers.rpdo_slots),
      tpdos_(buffers.tpdos, dictionary_, queue_) {}

void Node::start(std::uint64_t now_us) { reset(NmtCommand::kResetNode, now_us); }

void Node::on_frame(const hal::CanFrame& frame, std::uint64_t now_us) {
  // Remote frames would ask for node guarding or a PDO; both are out of use (CiA AN 802).
  if (frame.remote || state_ == NmtState::kInitialising) return;
  if (frame.identifier == (sync_cob_id_ & kCobIdMask)) return on_sync(now_us);
  // Between these bounds only PDOs lie; an identifier outside them may be a PDO's too.
  const bool pdo = frame.identifier >= kTpdo1Base && frame.identifier < kSdoResponseBase;
  if (!pdo && serve(frame, now_us)) return;
  if (!permits_pdo(state_)) return;
  const std::size_t number = rpdos_.find(frame.identifier);
  if (number != SlotMap::kNone) on_rpdo(number, frame);
}

bool Node::serve(const hal::CanFrame& frame, std::uint64_t now_us) {
  if (frame.identifier == kNmtCobId) {
    on_nmt(frame, now_us);
    return true;
  }
  if (frame.identifier == server_.request_identifier()) {
    if (permits_sdo(state_)) server_.on_request(frame, *this, queue_, now_us);
    return true;
  }
  if (const auto heartbeat = decode_heartbeat(frame)) {
    on_heartbeat(*heartbeat, now_us);
    return true;
  }
  if (const auto emergency = decode_emergency(frame)) {
    application_.on_emergency(*emergency);
    return true;
  }
  return false;
}

void Node::process(std::uint64_t now_us) {
  queue_.flush();
  if (state_ == NmtState::kInitialising) return;
  if (now_us >= heartbeat_due_us_) produce_heartbeat(now_us);
  HeartbeatEvent event;
  while (heartbeats_.check(now_us, event)) application_.on_heartbeat(event);
  if (sync_period_us_ != 0) produce_sync(now_us);
  if (permits_pdo(state_)) tpdos_.process(now_us);
  server_.process(queue_, now_us);
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
  state_ = state;
  rpdos_.clear_pending();
  if (permits_pdo(state)) tpdos_.start(now_us);
  if (!permits_sdo(state)) server_.reset();
  application_.on_state(state);
}

void Node::reset(NmtCommand reset, std::uint64_t now_us) {
  enter(NmtState::kInitialising, now_us);
  if (reset == NmtCommand::kResetNode) errors_ = ErrorLog();
  load_defaults();
  application_.on_reset(reset);
  heartbeat_due_us_ = now_us + heartbeat_ms_ * 1000u;
  sync_due_us_ = now_us + sync_period_us_;
  static_cast<void>(queue_.send(encode(Heartbeat{node_id_, NmtState::kInitialising})));
  enter(NmtState::kPreOperational, now_us);
}

void Node::load_defaults() {
  heartbeat_ms_ = description_.heartbeat_ms;
  sync_cob_id_ = kSyncCobId | (description_.sync_producer ? kSyncProducer : 0);
  sync_period_us_ = description_.sync_period_us;
  heartbeats_.clear();
  bool possible = true;
  for (std::size_t i = 0; i < rpdos_.size(); ++i) {
    const bool described = i < description_.rpdos.size();
    possible &= configure_rpdo(i, described ? description_.rpdos[i] : PdoConfiguration{}) == AbortCode::kNone;
  }
  for (std::size_t i = 0; i < tpdos_.size(); ++i) {
    const bool described = i < description_.tpdos.size();
    possible &= configure_tpdo(i, described ? description_.tpdos[i] : PdoConfiguration{}) == AbortCode::kNone;
  }
  if (!possible) raise_error(error_code::kDataSet, error_register::kManufacturer);
}

AbortCode Node::configure_rpdo(std::size_t number, const PdoConfiguration& configuration) {
  if (number >= rpdos_.size()) return AbortCode::kObjectDoesNotExist;
  rpdos_[number].pending = false;
  const AbortCode configured = rpdos_[number].record.configure(configuration, node_id_, dictionary_);
  rpdos_.update_identifiers();
  return configured;
}

AbortCode Node::configure_tpdo(std::size_t number, const PdoConfiguration& configuration) {
  if (number >= tpdos_.size()) return AbortCode::kObjectDoesNotExist;
  tpdos_[number].requested = false;
  return tpdos_[number].record.configure(configuration, node_id_, dictionary_);
}

AbortCode Node::configure_consumer(std::size_t number, std::uint8_t node_id, std::uint16_t time_ms) {
  return heartbeats_.write(static_cast<std::uint8_t>(number + 1), std::uint32_t{node_id} << 16 | time_ms);
}

void Node::on_nmt(const hal::CanFrame& frame, std::uint64_t now_us) {
  const auto message = decode_nmt(frame);
  if (!message || (message->node_id != 0 && message->node_id != node_id_)) return;
  command(message->command, now_us);
}

void Node::on_sync(std::uint64_t now_us) {
  if (!permits_sync(state_)) return;
  for (std::size_t i = 0; rpdo_pending_ && i < rpdos_.size(); ++i) {
    if (rpdos_[i].pending) take_effect(i, rpdos_[i], rpdos_[i].data);
  }
  rpdo_pending_ = false;
  application_.on_sync(now_us);
  if (permits_pdo(state_)) tpdos_.on_sync(now_us);
}

void Node::on_heartbeat(const Heartbeat& heartbeat, std::uint64_t now_us) {
  HeartbeatEvent event;
  if (heartbeats_.on_heartbeat(heartbeat, now_us, event)) application_.on_heartbeat(event);
}

void Node::on_rpdo(std::size_t number, const hal::CanFrame& frame) {
  Rpdo& pdo = rpdos_[number];
  const std::uint8_t expected = pdo.record.size_bytes();
  const Length length = frame.size == expected  ? Length::kRight
                        : frame.size < expected ? Length::kTooShort
                                                : Length::kTooLong;
  if (length != pdo.length) note_length(number, length);
  if (length == Length::kTooShort) return;
  if (!pdo.record.synchronous()) return take_effect(number, pdo, frame.data);
  pdo.data = frame.data;
  pdo.pending = true;
  rpdo_pending_ = true;
}

void Node::take_effect(std::size_t number, Rpdo& pdo, const std::array<std::uint8_t, 8>& data) {
  pdo.pending = false;
  pdo.record.unpack(dictionary_, data.data());
  application_.on_rpdo(number);
}

void Node::note_length(std::size_t number, Length length) {
  rpdos_[number].length = length;
  const std::array<std::uint8_t, 5> which{static_cast<std::uint8_t>(number + 1)};
  if (length == Length::kTooShort)
    raise_error(error_code::kPdoTooShort, error_register::kCommunication, which);
  if (length == Length::kTooLong) raise_error(error_code::kPdoTooLong, error_register::kCommunication, which);
  if (!rpdos_.any(Length::kTooShort)) clear_error(error_code::kPdoTooShort);
  if (!rpdos_.any(Length::kTooLong)) clear_error(error_code::kPdoTooLong);
}

void Node::send_sync(std::uint64_t now_us) {
  if (!permits_sync(state_)) return;
  static_cast<void>(queue_.send({.identifier = static_cast<std::uint16_t>(sync_cob_id_ & kCobIdMask)}));
  on_sync(now_us);
}

void Node::produce_sync(std::uint64_t now_us) {
  const bool produces = (sync_cob_id_ & kSyncProducer) != 0 && permits_sync(state_);
  if (!produces || now_us < sync_due_us_) return;
  send_sync(now_us);
  sync_due_us_ = next_beat(sync_due_us_, sync_period_us_, now_us);
}

void Node::produce_heartbeat(std::uint64_t now_us) {
  if (heartbeat_ms_ == 0) return;
  static_cast<void>(queue_.send(encode(Heartbeat{node_id_, state_})));
  heartbeat_due_us_ = next_beat(heartbeat_due_us_, heartbeat_ms_ * 1000u, now_us);
}

void Node::raise_error(std::uint16_t code, std::uint8_t register_bits,
                       const std::array<std::uint8_t, 5>& manufacturer) {
  if (errors_.raise(code, register_bits, load_u16(manufacturer.data()))) send_emergency(code, manufacturer);
}

void Node::clear_error(std::uint16_t code) {
  if (errors_.clear(code)) send_emergency(error_code::kNoError, {});
}

void Node::send_emergency(std::uint16_t code, const std::array<std::uint8_t, 5>& manufacturer) {
  if (!permits_emergency(state_)) return;
  static_cast<void>(queue_.send(encode(Emergency{node_id_, code, errors_.error_register(), manufacturer})));
}

}  // namespace koboshi::canopen
