#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "sim_board/board/sim_board.h"
#include "simulation/scenario/object_access.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// An SDO write to the controller's dictionary that a scenario's parameter requires.
struct SdoWrite {
  SourcedName parameter;
  canopen::ObjectAddress address;
  std::uint8_t size_bytes = 0;  // 1..4
  std::uint32_t value = 0;
};

// The controller has refused a value or not answered.
class SdoFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Returns the frames by which an operator gives a command to the controller, in their order.
std::vector<hal::CanFrame> command_frames(const Command& command);

// The operator's PC: writes the controller's parameters by SDO, one after the other, and then sends commands
// and accesses objects. It repeats the velocity of a walk until another command ends the walk, because the
// controller ends a walk whose velocity is not repeated (0x1401:5), and the targets of a stream likewise. It
// leaves the walk or the stream to another operator whose command or velocity it hears on the bus.
class OperatorPc final : private sim_board::BusNode, private canopen::FrameSink {
 public:
  // Period of the velocity of a walk: one of two may be lost within the controller's default deadline of
  // 500 ms.
  static constexpr std::uint64_t kVelocityPeriod_us = 200'000;
  // Period of the sets of a stream: three of four may be lost within the controller's default deadline of
  // 100 ms.
  static constexpr std::uint64_t kStreamPeriod_us = 20'000;

  // The board must outlive the PC.
  OperatorPc(sim_board::SimBoard& board, std::vector<SdoWrite> writes);
  ~OperatorPc() { board_.electronics().set_operator_listener(nullptr); }
  OperatorPc(const OperatorPc&) = delete;
  OperatorPc& operator=(const OperatorPc&) = delete;

  // Call it before each millisecond of the board. Throws SdoFailed if the controller refuses a value or does
  // not answer within 100 ms.
  void advance();
  // Returns whether all parameters are written, so that the PC may send commands.
  bool ready() const { return written_ == writes_.size(); }
  void command(const Command& command);
  // Sends a set of the joint target stream at once, in place of those that it repeats. The set has one target
  // for each joint of the robot, and as many torque limits or none.
  void stream(const StreamSet& set);
  // Appends a parameter write. Commands wait for it.
  void write(SdoWrite write);

  // Accesses an object once all parameters are written. Writes and accesses wait for each other.
  void request(ObjectRequest request) { access_.request(std::move(request)); }
  [[nodiscard]] std::vector<ObjectAnswer> take_answers() { return access_.take_answers(); }

  void archive(sim_board::StateArchive& archive);

 private:
  void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override;
  bool send(const hal::CanFrame& frame) override { return board_.electronics().send_as_operator(frame); }
  void repeat_velocity();
  void repeat_stream();
  void begin_stream(const Command& command);
  void send_sequence();
  void write_parameters();
  [[noreturn]] void give_up(const ObjectAnswer& answer) const;

  sim_board::SimBoard& board_;
  std::vector<SdoWrite> writes_;
  std::size_t written_ = 0;
  ObjectAccess parameters_;  // executes writes_, in whose order its requests are numbered
  ObjectAccess access_;
  std::optional<hal::CanFrame> velocity_;  // of the walk that this operator holds
  std::uint64_t velocity_due_us_ = 0;
  bool streams_ = false;  // repeats the set that the controller has
  std::uint64_t stream_due_us_ = 0;
  std::uint8_t sequence_ = 0;  // of the next set
};

}  // namespace koboshi::simulation
