#include "simulation/scenario/operator_pc.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace koboshi::simulation {
namespace {

// Time in a control cycle at which the bus is idle, so that a repeated velocity delays no other frame: the
// frames of a cycle end 6.6 ms after its start (measured on scenarios/go.yaml, 2026-11-25).
constexpr std::uint64_t kIdle_us = 8'000;

std::uint8_t code_of(Command::Kind kind) {
  switch (kind) {
    case Command::Kind::kEnable:
      return 1;
    case Command::Kind::kPlay:
      return 3;
    case Command::Kind::kStop:
      return 4;
    case Command::Kind::kEmergencyStop:
      return 5;
    case Command::Kind::kReset:
      return 6;
    case Command::Kind::kWalk:
      return 7;
    case Command::Kind::kGetUp:
      return 9;
  }
  return 0;
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

void OperatorPc::on_frame(const hal::CanFrame& frame, std::uint64_t time_us) {
  const bool takes_over =
      frame.identifier == sim_board::kCommandIdentifier && frame.data[0] != code_of(Command::Kind::kPlay);
  if (takes_over || frame.identifier == sim_board::kVelocityIdentifier) velocity_.reset();
  if (!parameters_.on_frame(frame, time_us)) static_cast<void>(access_.on_frame(frame, time_us));
}

void OperatorPc::give_up(const ObjectAnswer& answer) const {
  const SourcedName& parameter = writes_[answer.number].parameter;
  throw SdoFailed(fmt::format("{}:{}: the controller does not take {} (SDO abort 0x{:08X})",
                              parameter.source.string(), parameter.line, parameter.text,
                              static_cast<std::uint32_t>(answer.abort)));
}

}  // namespace koboshi::simulation
