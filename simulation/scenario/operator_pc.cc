#include "simulation/scenario/operator_pc.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "firmware/app/dictionary.h"
#include "firmware/behaviour/command.h"
#include "firmware/canopen/frame.h"

namespace koboshi::simulation {
namespace {

// Time in a control cycle at which the bus is idle, so that a repeated velocity delays no other frame: the
// frames of a cycle end 6.6 ms after its start (measured on scenarios/go.yaml, 2026-11-25).
constexpr std::uint64_t kIdle_us = 8'000;

behaviour::Command command_of(Command::Kind kind) {
  switch (kind) {
    case Command::Kind::kEnable:
      return behaviour::Command::kEnable;
    case Command::Kind::kPlay:
      return behaviour::Command::kPlay;
    case Command::Kind::kStop:
      return behaviour::Command::kStop;
    case Command::Kind::kEmergencyStop:
      return behaviour::Command::kEmergencyStop;
    case Command::Kind::kReset:
      return behaviour::Command::kReset;
    case Command::Kind::kWalk:
      return behaviour::Command::kWalk;
    case Command::Kind::kGetUp:
      return behaviour::Command::kGetUp;
    case Command::Kind::kStream:
      return behaviour::Command::kStream;
  }
  return behaviour::Command::kNone;
}

// The value of object 0x2000.
std::uint8_t code_of(Command::Kind kind) { return static_cast<std::uint8_t>(command_of(kind)); }

// An angle in the unit of object 0x2161, 2^-16 turn. Saturates.
std::int16_t stream_units(double angle_rad) {
  constexpr double kUnitsPerRad = 65536.0 / (2.0 * std::numbers::pi);
  const double units = std::clamp(std::nearbyint(angle_rad * kUnitsPerRad), -32768.0, 32767.0);
  return static_cast<std::int16_t>(units);
}

// A torque limit in the unit of object 0x2162.
std::uint8_t torque_units(double percent) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(percent, 1.0, 100.0)));
}

// The frames that carry these bytes, eight to a frame, with consecutive identifiers.
std::vector<hal::CanFrame> split(std::span<const std::uint8_t> bytes, std::uint32_t first_identifier) {
  std::vector<hal::CanFrame> frames;
  for (std::size_t at = 0; at < bytes.size(); at += hal::CanFrame().data.size()) {
    hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(first_identifier + frames.size())};
    frame.size = static_cast<std::uint8_t>(std::min(frame.data.size(), bytes.size() - at));
    std::ranges::copy(bytes.subspan(at, frame.size), frame.data.begin());
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace

OperatorPc::OperatorPc(sim_board::SimBoard& board, std::vector<SdoWrite> writes)
    : board_(board), parameters_(*this), access_(*this) {
  for (SdoWrite& parameter : writes) write(std::move(parameter));
  board_.electronics().set_operator_listener(this);
}

void OperatorPc::write(SdoWrite write) {
  std::vector<std::uint8_t> data(write.size_bytes);
  for (std::size_t byte = 0; byte < data.size(); ++byte)
    data[byte] = static_cast<std::uint8_t>(write.value >> (8 * byte));
  parameters_.request({.number = writes_.size(),
                       .node_id = sim_board::kControllerNode,
                       .address = write.address,
                       .data = std::move(data)});
  writes_.push_back(std::move(write));
}

void OperatorPc::advance() {
  repeat_velocity();
  repeat_stream();
  if (!access_.busy()) write_parameters();
  if (ready() || access_.busy()) access_.process(board_.now_us());
}

void OperatorPc::write_parameters() {
  parameters_.process(board_.now_us());
  for (const ObjectAnswer& answer : parameters_.take_answers()) {
    if (answer.abort != canopen::AbortCode::kNone) give_up(answer);
    ++written_;
  }
}

// A walk command is preceded by its velocity.
std::vector<hal::CanFrame> command_frames(const Command& command) {
  std::vector<hal::CanFrame> frames;
  if (command.kind == Command::Kind::kWalk) {
    hal::CanFrame velocity{.identifier = sim_board::kVelocityIdentifier, .size = 6};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto thousandths =
          static_cast<std::int16_t>(std::lround(1000.0 * command.velocity[static_cast<int>(axis)]));
      canopen::store_u16(velocity.data.data() + 2 * axis, static_cast<std::uint16_t>(thousandths));
    }
    frames.push_back(velocity);
  }
  hal::CanFrame frame{.identifier = sim_board::kCommandIdentifier, .size = 3};
  frame.data[0] = code_of(command.kind);
  frame.data[1] = static_cast<std::uint8_t>(command.motion);
  frames.push_back(frame);
  return frames;
}

void OperatorPc::command(const Command& command) {
  const std::vector<hal::CanFrame> frames = command_frames(command);
  for (const hal::CanFrame& frame : frames) static_cast<void>(send(frame));
  // A motion is played beside the walk.
  if (command.kind == Command::Kind::kPlay) return;
  velocity_.reset();
  streams_ = false;
  if (command.kind == Command::Kind::kStream) return begin_stream(command);
  if (command.kind != Command::Kind::kWalk) return;
  velocity_ = frames.front();
  const std::uint64_t due_us = board_.now_us() + kVelocityPeriod_us;
  velocity_due_us_ = due_us - due_us % sim_board::SimBoard::kTick_us + kIdle_us;
}

void OperatorPc::repeat_velocity() {
  if (!velocity_ || board_.now_us() < velocity_due_us_) return;
  static_cast<void>(send(*velocity_));
  velocity_due_us_ += kVelocityPeriod_us;
}

// The controller begins with its present targets: the joints that the command names are written by SDO.
void OperatorPc::begin_stream(const Command& command) {
  for (const StreamedJoint& streamed : command.stream) {
    const auto joint =
        static_cast<std::size_t>(*board_.electronics().robot().find_joint(streamed.joint.text));
    write({.parameter = streamed.joint,
           .address = {app::kStreamTargetObject, static_cast<std::uint8_t>(joint + 1)},
           .size_bytes = 2,
           .value = static_cast<std::uint16_t>(stream_units(streamed.target_rad))});
  }
  streams_ = !command.stream.empty();
  stream_due_us_ = board_.now_us() + kStreamPeriod_us;
}

void OperatorPc::repeat_stream() {
  if (!streams_ || !ready() || board_.now_us() < stream_due_us_) return;
  send_sequence();
  stream_due_us_ = board_.now_us() + kStreamPeriod_us;
}

void OperatorPc::send_sequence() {
  hal::CanFrame frame{.identifier = app::kStreamSequenceIdentifier, .size = 1};
  frame.data[0] = sequence_++;
  static_cast<void>(send(frame));
}

void OperatorPc::stream(const StreamSet& set) {
  streams_ = false;
  std::vector<std::uint8_t> targets(2 * set.targets_rad.size());
  for (std::size_t joint = 0; joint < set.targets_rad.size(); ++joint)
    canopen::store_u16(&targets[2 * joint], static_cast<std::uint16_t>(stream_units(set.targets_rad[joint])));
  std::vector<std::uint8_t> torques;
  for (const double percent : set.torque_limits_percent) torques.push_back(torque_units(percent));
  for (const hal::CanFrame& frame : split(targets, app::kStreamTargetBase)) static_cast<void>(send(frame));
  for (const hal::CanFrame& frame : split(torques, app::kStreamTorqueBase)) static_cast<void>(send(frame));
  send_sequence();
}

void OperatorPc::on_frame(const hal::CanFrame& frame, std::uint64_t time_us) {
  if (frame.remote) return;  // it commands nothing
  const bool takes_over =
      frame.identifier == sim_board::kCommandIdentifier && frame.data[0] != code_of(Command::Kind::kPlay);
  if (takes_over || frame.identifier == sim_board::kVelocityIdentifier) velocity_.reset();
  if (takes_over) streams_ = false;
  if (!parameters_.on_frame(frame, time_us)) static_cast<void>(access_.on_frame(frame, time_us));
}

void OperatorPc::give_up(const ObjectAnswer& answer) const {
  const SourcedName& parameter = writes_[answer.number].parameter;
  throw SdoFailed(fmt::format("{}:{}: the controller does not take {} (SDO abort 0x{:08X})",
                              parameter.source.string(), parameter.line, parameter.text,
                              static_cast<std::uint32_t>(answer.abort)));
}

void OperatorPc::archive(sim_board::StateArchive& archive) {
  archive(writes_, written_, parameters_, access_, velocity_, velocity_due_us_, streams_, stream_due_us_,
          sequence_);
}

}  // namespace koboshi::simulation
