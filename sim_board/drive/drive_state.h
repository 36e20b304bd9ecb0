#pragma once

#include <cstdint>

#include "firmware/canopen/cia402.h"

namespace koboshi::sim_board {

// The power drive system finite state automaton of CiA 402-2, figure 5. Quick stop and fault reaction last
// until their owner reports that the shaft stands.
class DriveStateMachine {
 public:
  using State = canopen::cia402::State;

  State state() const { return state_; }
  bool makes_torque() const {
    return state_ == State::kOperationEnabled || state_ == State::kQuickStopActive ||
           state_ == State::kFaultReactionActive;
  }

  void initialised();  // transition 1
  // Transitions 2 to 12, 15 and, where the quick stop option code has it (`resumes`), 16; edges of fault
  // reset are seen between calls.
  void command(std::uint16_t controlword, bool resumes = false);
  // The last command does not take effect: back to the state before it.
  void refuse(State before) { state_ = before; }
  void fault();        // transition 13
  void stand_still();  // transitions 12 and 14: the ramp has ended
  void torque_off();   // the drive-enable line fell: transitions 7, 9, 10, 12; ends a fault reaction

 private:
  State on_command(canopen::cia402::Command command, bool resumes) const;

  State state_ = State::kNotReadyToSwitchOn;
  std::uint16_t controlword_ = 0;
};

}  // namespace koboshi::sim_board
