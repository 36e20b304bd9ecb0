#include "sim_board/drive/drive_state.h"

namespace koboshi::sim_board {

using canopen::cia402::Command;
using canopen::cia402::kFaultReset;

void DriveStateMachine::initialised() {
  if (state_ == State::kNotReadyToSwitchOn) state_ = State::kSwitchOnDisabled;
}

void DriveStateMachine::command(std::uint16_t controlword, bool resumes) {
  const bool reset_edge = (controlword & ~controlword_ & kFaultReset) != 0;
  controlword_ = controlword;
  if (state_ == State::kFault) {
    if (reset_edge) state_ = State::kSwitchOnDisabled;
    return;
  }
  state_ = on_command(canopen::cia402::command_of(controlword), resumes);
}

DriveStateMachine::State DriveStateMachine::on_command(Command command, bool resumes) const {
  if (state_ == State::kNotReadyToSwitchOn || state_ == State::kFaultReactionActive) return state_;
  switch (command) {
    case Command::kDisableVoltage:
      return State::kSwitchOnDisabled;
    case Command::kQuickStop:
      return state_ == State::kOperationEnabled || state_ == State::kQuickStopActive
                 ? State::kQuickStopActive
                 : State::kSwitchOnDisabled;
    case Command::kShutdown:
      return state_ == State::kQuickStopActive ? state_ : State::kReadyToSwitchOn;
    case Command::kSwitchOn:
      return state_ == State::kReadyToSwitchOn || state_ == State::kOperationEnabled ? State::kSwitchedOn
                                                                                     : state_;
    case Command::kEnableOperation:
      // Ready to switch on passes through switched on (transitions 3 and 4 in one, which the profile allows).
      return state_ == State::kSwitchOnDisabled || (state_ == State::kQuickStopActive && !resumes)
                 ? state_
                 : State::kOperationEnabled;
  }
  return state_;
}

void DriveStateMachine::fault() {
  if (state_ == State::kFault || state_ == State::kFaultReactionActive) return;
  state_ = makes_torque() ? State::kFaultReactionActive : State::kFault;
}

void DriveStateMachine::stand_still() {
  if (state_ == State::kQuickStopActive) state_ = State::kSwitchOnDisabled;
  if (state_ == State::kFaultReactionActive) state_ = State::kFault;
}

void DriveStateMachine::torque_off() {
  if (state_ == State::kFault || state_ == State::kFaultReactionActive) {
    state_ = State::kFault;
  } else if (state_ != State::kNotReadyToSwitchOn) {
    state_ = State::kSwitchOnDisabled;
  }
}

}  // namespace koboshi::sim_board
