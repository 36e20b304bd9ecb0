#include "firmware/canopen/lss_slave.h"

namespace koboshi::canopen {
namespace {

// Error codes of the answers to 11h, 13h and 17h (CiA 305, 6.2.2).
constexpr std::uint8_t kDone = 0;
constexpr std::uint8_t kOutOfRange = 1;  // of a node id; of a bit timing: not supported
constexpr std::uint8_t kNoStorage = 1;
constexpr std::uint8_t kStorageFailed = 2;

constexpr std::uint8_t kStandardTimings = 0;  // table of CiA 301
constexpr std::uint8_t kOneMegabit = 0;       // in it
constexpr std::uint8_t kConfirm = 0x80;       // BitCheck of fastscan: whether there are any slaves
constexpr std::uint8_t kBits = 32;

constexpr std::uint8_t number(LssCommand command) { return static_cast<std::uint8_t>(command); }

// The place of a command in the run of commands that begins with `first`; a large number for one before it.
constexpr std::size_t place(std::uint8_t command, LssCommand first) {
  return static_cast<std::size_t>(static_cast<std::uint8_t>(command - number(first)));
}

constexpr bool is_node_id(std::uint8_t id) {
  return (id >= 1 && id <= kMaxNodeId) || id == kUnconfiguredNodeId;
}

void answer(FrameSink& sink, LssCommand command, std::uint32_t value = 0) {
  hal::CanFrame frame{.identifier = kLssResponseCobId, .size = 8};
  frame.data[0] = number(command);
  store_u32(&frame.data[1], value);
  static_cast<void>(sink.send(frame));
}

}  // namespace

void LssSlave::restart(std::uint8_t node_id) {
  state_ = State::kWaiting;
  node_id_ = node_id;
  selected_ = 0;
  identified_ = 0;
  scanned_ = 0;
}

LssSlave::Event LssSlave::on_request(const hal::CanFrame& frame, std::uint8_t active_node_id,
                                     FrameSink& sink) {
  const std::uint8_t command = frame.data[0];
  const std::uint32_t value = load_u32(&frame.data[1]);
  const std::size_t selected = place(command, LssCommand::kSwitchVendor);
  const std::size_t identified = place(command, LssCommand::kIdentifyVendor);
  const bool unconfigured = active_node_id == kUnconfiguredNodeId && node_id_ == kUnconfiguredNodeId;
  if (command == number(LssCommand::kSwitchGlobal)) return switch_globally(frame.data[1]);
  if (identified <= place(number(LssCommand::kIdentifySerialHigh), LssCommand::kIdentifyVendor)) {
    identify(identified, value, sink);
  } else if (command == number(LssCommand::kIdentifyUnconfigured)) {
    if (unconfigured) answer(sink, LssCommand::kIdentifiedUnconfigured);
  } else if (state_ == State::kConfiguration) {
    return configure(frame, active_node_id, sink);
  } else if (selected < address_.size()) {
    switch_selectively(selected, value, sink);
  } else if (command == number(LssCommand::kFastscan) && unconfigured) {
    fastscan(frame, sink);
  }
  return Event::kNone;
}

LssSlave::Event LssSlave::switch_globally(std::uint8_t mode) {
  if (mode > 1) return Event::kNone;
  const bool leaves = state_ == State::kConfiguration && mode == 0;
  state_ = mode == 0 ? State::kWaiting : State::kConfiguration;
  selected_ = 0;
  return leaves ? Event::kLeft : Event::kNone;
}

// The four parts of the address arrive in sequence; the first restarts it.
void LssSlave::switch_selectively(std::size_t part, std::uint32_t value, FrameSink& sink) {
  if (part == 0) selected_ = 0;
  selected_ = part == selected_ && value == address_[part] ? part + 1 : 0;
  if (selected_ != address_.size()) return;
  selected_ = 0;
  state_ = State::kConfiguration;
  answer(sink, LssCommand::kSwitched);
}

// Answers if vendor and product are the slave's, and its revision and serial number are within the limits.
void LssSlave::identify(std::size_t part, std::uint32_t value, FrameSink& sink) {
  constexpr std::size_t kParts = 6;
  const bool matches[kParts] = {value == address_[0], value == address_[1], value <= address_[2],
                                value >= address_[2], value <= address_[3], value >= address_[3]};
  if (part == 0) identified_ = 0;
  identified_ = part == identified_ && matches[part] ? part + 1 : 0;
  if (identified_ != kParts) return;
  identified_ = 0;
  answer(sink, LssCommand::kIdentified);
}

// LSS fastscan: an answer means that the bits from BitCheck upwards of some slave's address part equal those
// of the request. With the last bit of the last part, the one slave that is left enters configuration.
void LssSlave::fastscan(const hal::CanFrame& frame, FrameSink& sink) {
  const std::uint32_t wanted = load_u32(&frame.data[1]);
  const std::uint8_t bit = frame.data[5];
  const std::uint8_t part = frame.data[6];
  const std::uint8_t next = frame.data[7];
  if (bit == kConfirm) {
    scanned_ = 0;
    return answer(sink, LssCommand::kIdentified);
  }
  if (bit >= kBits || part != scanned_ || part >= address_.size() || next >= address_.size()) return;
  if (((wanted ^ address_[part]) >> bit) != 0) return;
  scanned_ = next;
  if (bit == 0 && next < part) state_ = State::kConfiguration;
  answer(sink, LssCommand::kIdentified);
}

LssSlave::Event LssSlave::configure(const hal::CanFrame& frame, std::uint8_t active_node_id,
                                    FrameSink& sink) {
  const std::uint8_t command = frame.data[0];
  const std::size_t inquired = place(command, LssCommand::kInquireVendor);
  if (command == number(LssCommand::kConfigureNodeId)) {
    const bool possible = is_node_id(frame.data[1]);
    if (possible) node_id_ = frame.data[1];
    answer(sink, LssCommand::kConfigureNodeId, possible ? kDone : kOutOfRange);
  } else if (command == number(LssCommand::kConfigureBitTiming)) {
    const bool possible = frame.data[1] == kStandardTimings && frame.data[2] == kOneMegabit;
    answer(sink, LssCommand::kConfigureBitTiming, possible ? kDone : kOutOfRange);
  } else if (command == number(LssCommand::kStore)) {
    return Event::kStore;
  } else if (inquired < address_.size()) {
    answer(sink, static_cast<LssCommand>(command), address_[inquired]);
  } else if (command == number(LssCommand::kInquireNodeId)) {
    answer(sink, LssCommand::kInquireNodeId, active_node_id);
  }
  return Event::kNone;
}

void LssSlave::stored(AbortCode result, FrameSink& sink) {
  answer(sink, LssCommand::kStore,
         result == AbortCode::kNone             ? kDone
         : result == AbortCode::kCannotTransfer ? kNoStorage
                                                : kStorageFailed);
}

}  // namespace koboshi::canopen
