#include "firmware/canopen/node/device_services.h"

#include <cstdint>

#include "firmware/canopen/frame.h"
#include "firmware/canopen/node/node.h"

namespace koboshi::canopen {
namespace {

constexpr std::uint8_t kTimeMessageSize = 6;
constexpr std::uint32_t kMillisecondBits = 0x0FFF'FFFF;

constexpr std::uint16_t kTimeObject = 0x1012;
constexpr std::uint16_t kVerificationObject = 0x1020;
constexpr std::uint8_t kVerificationParts = 2;  // date, time
constexpr std::uint16_t kEndOfCommunicationArea = 0x2000;

// Whether an object configures the node: parameters, and in the communication profile area all objects but
// the error history, store, restore, and the verification itself.
bool configures(const Node& node, ObjectAddress address) {
  const bool commands = address.index == 0x1003 || address.index == 0x1010 || address.index == 0x1011 ||
                        address.index == kVerificationObject;
  if (address.index < kEndOfCommunicationArea) return !commands;
  Location location;
  const Dictionary objects(node.description().rows, {});
  return objects.find(address, location) == AbortCode::kNone && is_parameter(*location.entry);
}

}  // namespace

// --- TIME

AbortCode TimeStamp::write_cob_id(std::uint32_t value) {
  const auto identifier = static_cast<std::uint16_t>(value & kCobIdMask);
  const bool consumes = (value & kTimeConsumer) != 0;
  if ((value & ~(kTimeConsumer | kCobIdMask)) != 0) return AbortCode::kInvalidValue;
  if (consumes && is_restricted(identifier)) return AbortCode::kInvalidValue;
  const bool in_use = consumes && (cob_id_ & kTimeConsumer) != 0;
  if (in_use && identifier != (cob_id_ & kCobIdMask)) return AbortCode::kInvalidValue;
  cob_id_ = value;
  return AbortCode::kNone;
}

bool TimeStamp::accept(const hal::CanFrame& frame, std::uint64_t now_us) {
  const TimeOfDay told{load_u32(&frame.data[0]) & kMillisecondBits, load_u16(&frame.data[4])};
  if (frame.size != kTimeMessageSize || told.ms >= kMillisecondsPerDay) return false;
  last_ = told;
  last_us_ = now_us;
  return true;
}

TimeOfDay TimeStamp::advanced(std::uint64_t now_us) const {
  const std::uint64_t ms = last_->ms + (now_us - last_us_) / 1000;
  return TimeOfDay{static_cast<std::uint32_t>(ms % kMillisecondsPerDay),
                   static_cast<std::uint16_t>(last_->days + ms / kMillisecondsPerDay)};
}

// --- Services

// Reset node forgets a node id that has not been stored; reset communication activates it (CiA 305).
void DeviceServices::on_reset(Node& node, NmtCommand reset) {
  if (reset == NmtCommand::kResetNode) lss_.restart(stored_node_id_);
  time_.load_defaults();
  verification_ = {};
  node.set_node_id(lss_.node_id());
  owner_.on_node_id(lss_.node_id());
}

bool DeviceServices::on_frame(Node& node, const hal::CanFrame& frame, std::uint64_t now_us) {
  if (LssSlave::takes(frame)) {
    on_lss(node, frame, now_us);
    return true;
  }
  if (!permits_time(node.state()) || !time_.identifies(frame)) return false;
  if (time_.accept(frame, now_us)) owner_.on_time(*time_.at(now_us));
  return true;
}

void DeviceServices::on_lss(Node& node, const hal::CanFrame& frame, std::uint64_t now_us) {
  switch (lss_.on_request(frame, node.node_id(), node.sink())) {
    case LssSlave::Event::kNone:
      return;
    case LssSlave::Event::kStore:
      node_id_to_store_ = lss_.node_id();
      return store_node_id(node);
    case LssSlave::Event::kLeft:
      // A node without id boots with the one just assigned; others wait for a reset (CiA 305, figure 4).
      if (node.node_id() == kUnconfiguredNodeId && lss_.node_id() != kUnconfiguredNodeId) {
        node.command(NmtCommand::kResetCommunication, now_us);
      }
      return;
  }
}

void DeviceServices::store_node_id(Node& node) {
  const AbortCode stored = owner_.on_store_node_id(*node_id_to_store_);
  if (stored == AbortCode::kBusy) return;
  if (stored == AbortCode::kNone) stored_node_id_ = *node_id_to_store_;
  node_id_to_store_.reset();
  lss_.stored(stored, node.sink());
}

AbortCode DeviceServices::read(ObjectAddress address, ObjectValue& value) const {
  const bool time = address.index == kTimeObject;
  if (!time && address.index != kVerificationObject) return AbortCode::kObjectDoesNotExist;
  if (address.subindex > (time ? 0 : kVerificationParts)) return AbortCode::kSubindexDoesNotExist;
  if (time) {
    value.set_number(time_.cob_id(), 4);
  } else if (address.subindex == 0) {
    value.set_number(kVerificationParts, 1);
  } else {
    value.set_number(verification_[address.subindex - 1u], 4);
  }
  return AbortCode::kNone;
}

// A change of the configuration resets 0x1020: it verified the old one.
AbortCode DeviceServices::write(Node& node, ObjectAddress address, std::uint32_t value, std::size_t size) {
  ObjectValue before;
  ObjectValue after;
  const bool known = configures(node, address) && node.read_object(address, before) == AbortCode::kNone;
  const AbortCode own = write_own(address, value, size);
  const AbortCode written =
      own == AbortCode::kObjectDoesNotExist ? node.write_own(address, value, size) : own;
  if (written != AbortCode::kNone || !known) return written;
  static_cast<void>(node.read_object(address, after));
  if (after.number() != before.number()) verification_ = {};
  return written;
}

AbortCode DeviceServices::write_own(ObjectAddress address, std::uint32_t value, std::size_t size) {
  ObjectValue present;
  const AbortCode found = read(address, present);
  if (found != AbortCode::kNone) return found;
  if (address.index == kVerificationObject && address.subindex == 0) return AbortCode::kWriteOfReadOnly;
  const AbortCode sized = check_size(size, present.size());
  if (sized != AbortCode::kNone) return sized;
  if (address.index == kTimeObject) return time_.write_cob_id(value);
  verification_[address.subindex - 1u] = value;
  return AbortCode::kNone;
}

}  // namespace koboshi::canopen
