#include "simulation/scenario/operator_pc.h"

#include <cmath>
#include <cstdio>
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
    : board_(board), writes_(std::move(writes)), client_(*this), access_(*this) {
  board_.set_operator_listener(this);
}

void OperatorPc::advance() {
  repeat_velocity();
  client_.process(board_.now_us());
  if (client_.state() == canopen::SdoState::kAborted || client_.state() == canopen::SdoState::kTimedOut) {
    give_up();
  }
  if (client_.state() == canopen::SdoState::kDone) {
    client_.reset();
    ++next_;
  }
  if (client_.state() == canopen::SdoState::kBusy) return;
  if (ready() || access_.busy()) return access_.process(board_.now_us());
  const SdoWrite& write = writes_[next_];
  // The FIFO holds far more frames than the PC sends in a millisecond.
  static_cast<void>(client_.begin_write(sim_board::kControllerNode, write.address, write.value,
                                        write.size_bytes, board_.now_us()));
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
  if (!client_.on_frame(frame)) static_cast<void>(access_.on_frame(frame, time_us));
}

void OperatorPc::give_up() const {
  const SourcedName& parameter = writes_[next_].parameter;
  char code[16];
  std::snprintf(code, sizeof(code), "0x%08X", static_cast<unsigned>(client_.abort_code()));
  throw SdoFailed(parameter.source.string() + ":" + std::to_string(parameter.line) +
                  ": the controller does not take " + parameter.text + " (SDO abort " + code + ")");
}

}  // namespace koboshi::simulation
