#include "firmware/app/node_callbacks.h"

#include <span>

#include "firmware/app/factory_parameters.h"
#include "firmware/app/telemetry.h"
#include "firmware/storage/image.h"

namespace koboshi::app {

using canopen::AbortCode;
using canopen::NmtCommand;

namespace {

std::uint16_t motion_number(canopen::ObjectAddress address) {
  return static_cast<std::uint16_t>(address.subindex - 1);
}

// The parameters of the application are manufacturer specific: the robot has no standard profile.
canopen::ParameterGroup stored_group(canopen::ParameterGroup group) {
  using enum canopen::ParameterGroup;
  return group == kApplication ? kManufacturer : group;
}

}  // namespace

canopen::AbortCode NodeCallbacks::on_write(canopen::ObjectAddress address, std::uint32_t value) {
  if (address.index == kMotionCrcObject) return erase_motion(motion_number(address), value);
  if (address.index == kPolicyCrcObject) return erase_policy(value);
  const canopen::AbortCode answer = parts_.requests.write(address, value, now_us_);
  if (answer == AbortCode::kNone) {
    const bool commands = address.index == kRequestObject && address.subindex == kCommandSubindex;
    const Command command = commands ? static_cast<Command>(value) : Command::kNone;
    if (address.index == kVelocityObject || command == Command::kWalk) await_velocity();
    if (address.index == kStreamObject || command == Command::kStream) await_stream();
  }
  execute_decision();
  return answer;
}

// The deadline of the velocity covers every service that brings one, and a walk before the first one.
void NodeCallbacks::await_velocity() { parts_.node.restart_rpdo_timer(kVelocityRpdo, now_us_); }

// Likewise for the sets of a stream.
void NodeCallbacks::await_stream() { parts_.node.restart_rpdo_timer(kStreamRpdo, now_us_); }

bool NodeCallbacks::on_rpdo(std::size_t number) {
  if (number >= kStreamRpdo) {
    if (number == kStreamRpdo) static_cast<void>(parts_.requests.take_set(parts_.values.stream.sequence));
    return true;
  }
  if (number >= kFirstDriveRpdo) {
    parts_.drives.on_answer(number - kFirstDriveRpdo);
    return true;
  }
  bool accepted = true;
  if (number == kVelocityRpdo) accepted = parts_.requests.take_velocity();
  if (number == kCommandRpdo) {
    accepted = parts_.requests.take_command(now_us_);
    if (parts_.values.request.command == Command::kWalk) await_velocity();
    if (parts_.values.request.command == Command::kStream) await_stream();
  }
  execute_decision();
  return accepted;
}

// The program that repeats the velocity of a walk is gone: nobody could stop the robot. A robot that does not
// walk needs no velocity. The same holds for a stream.
bool NodeCallbacks::on_rpdo_timeout(std::size_t number) {
  if (number == kStreamRpdo) return parts_.behaviour.stop_stream();
  return number != kVelocityRpdo || parts_.behaviour.stop_walk();
}

void NodeCallbacks::execute_decision() {
  parts_.executor.execute(parts_.behaviour.decision(), now_us_);
  show(parts_.behaviour, parts_.values);
}

// --- Storage

canopen::Domain* NodeCallbacks::domain(canopen::ObjectAddress address) {
  if (address.index == kPolicyObject) {
    policy_transfer_.select(may_store());
    return &policy_transfer_;
  }
  motion_transfer_.select(motion_number(address), may_store());
  return &motion_transfer_;
}

canopen::AbortCode NodeCallbacks::on_read(canopen::ObjectAddress address, canopen::ObjectValue& value) {
  if (address.index == kFreeStorageObject) {
    value.set_number(static_cast<std::uint32_t>(parts_.items.free_bytes()), 4);
    return AbortCode::kNone;
  }
  if (address.index == kPolicyParameterObject) {
    value.set_number(static_cast<std::uint32_t>(parts_.policy.status()), 1);
    return AbortCode::kNone;
  }
  if (address.index == kPolicyNameObject || address.index == kPolicyCrcObject)
    return read_policy(address, value);
  motion::Motion motion;
  const auto image = parts_.motions.open_image(motion_number(address), motion);
  if (image.empty()) return AbortCode::kNoData;
  if (address.index == kMotionNameObject) {
    value.copy_text(motion.name());
  } else {
    value.set_number(storage::ImageReader(image.subspan(storage::kImageCrcOffset)).u32(), 4);
  }
  return AbortCode::kNone;
}

AbortCode NodeCallbacks::read_policy(canopen::ObjectAddress address, canopen::ObjectValue& value) {
  const policy::Policy* const policy = parts_.policy.open();
  if (policy == nullptr) return AbortCode::kNoData;
  if (address.index == kPolicyNameObject) {
    value.copy_text(policy->name());
  } else {
    value.set_number(policy->crc32(), 4);
  }
  return AbortCode::kNone;
}

// Erases a motion when a client writes 0 as its CRC.
canopen::AbortCode NodeCallbacks::erase_motion(std::uint16_t number, std::uint32_t value) {
  if (value != 0) return AbortCode::kInvalidValue;
  if (!may_store()) return AbortCode::kDeviceState;
  return canopen::abort_code_of(parts_.motions.erase(number));
}

// Likewise.
canopen::AbortCode NodeCallbacks::erase_policy(std::uint32_t value) {
  if (value != 0) return AbortCode::kInvalidValue;
  if (!may_store()) return AbortCode::kDeviceState;
  return canopen::abort_code_of(parts_.policy.erase());
}

canopen::AbortCode NodeCallbacks::on_store(canopen::ParameterGroup group) {
  return parameters_.store(stored_group(group), may_store());
}

canopen::AbortCode NodeCallbacks::on_restore(canopen::ParameterGroup group) {
  return parameters_.restore(stored_group(group), may_store());
}

// --- The network

// Reset Node acts like a power-on: no torque, stored parameters, and a boot. Reset Communication also boots,
// but keeps the application's state.
void NodeCallbacks::on_reset(NmtCommand reset) {
  const bool node = reset == NmtCommand::kResetNode;
  if (node) parts_.values.request = {};
  if (node) parts_.values.motion = {};
  if (node) parts_.values.stream = {};
  parts_.behaviour.restart(node, now_us_);
  execute_decision();
  if (node) {
    parts_.requests.reset_parameters();
    parts_.values.diagnosis.factory_parameters = load_factory_parameters();
    parameters_.load();
    parts_.requests.apply_parameters();
  } else {
    parts_.values.nmt_startup = kNmtMaster;
    parameters_.load(canopen::ParameterGroup::kCommunication);
  }
}

FactoryStatus NodeCallbacks::load_factory_parameters() {
  const auto values = std::as_writable_bytes(std::span(&parts_.values, 1));
  return app::load_factory_parameters(parts_.catalogue.find(storage::ItemKind::kFactoryParameters, 0),
                                      parts_.model.id, canopen::Dictionary(kControllerNode.rows, values));
}

// Reports factory parameters that are in storage and cannot be used. Before pre-operational a node sends no
// emergency messages.
void NodeCallbacks::report_factory_parameters() {
  const FactoryStatus status = parts_.values.diagnosis.factory_parameters;
  if (status == FactoryStatus::kLoaded || status == FactoryStatus::kNone) return;
  parts_.node.raise_error(canopen::error_code::kDataSet, canopen::error_register::kManufacturer,
                          {static_cast<std::uint8_t>(status)});
}

void NodeCallbacks::on_state(canopen::NmtState state) {
  if (state == canopen::NmtState::kPreOperational) report_factory_parameters();
  const bool boots = parts_.behaviour.state() == behaviour::State::kBoot;
  if (boots && state == canopen::NmtState::kOperational) parts_.network.on_operational(now_us_);
}

// Before its configuration a drive sends a heartbeat each second, as after its reset. That is slower than the
// consumer's time-out allows, so monitoring begins once all drives are configured.
void NodeCallbacks::on_heartbeat(const canopen::HeartbeatEvent& event) {
  parts_.drives.on_heartbeat(event);
  const bool booted_up = event.kind == canopen::HeartbeatEventKind::kBootedUp;
  if (booted_up || !parts_.drives.configured()) parts_.node.await_heartbeat(event.node_id);
}

// While the controller still listens, the network belongs to the other master: from then on it sends nothing
// that could disturb that one.
void NodeCallbacks::on_impostor(std::uint16_t) {
  if (!parts_.network.on_impostor()) return;
  parts_.drives.give_up();
  parts_.behaviour.fail(behaviour::Reason::kSecondMaster, parts_.drives.fault(), now_us_);
  execute_decision();
  parts_.node.mute(true);
}

}  // namespace koboshi::app
