#include "sim_board/drive/drive_state.h"

#include <gtest/gtest.h>

namespace koboshi::sim_board {
namespace {

using State = canopen::cia402::State;
namespace cia402 = canopen::cia402;

constexpr State kStates[] = {
    State::kNotReadyToSwitchOn, State::kSwitchOnDisabled, State::kReadyToSwitchOn,     State::kSwitchedOn,
    State::kOperationEnabled,   State::kQuickStopActive,  State::kFaultReactionActive, State::kFault};
constexpr std::uint16_t kWords[] = {cia402::kControlDisableVoltage,  cia402::kControlQuickStop,
                                    cia402::kControlShutdown,        cia402::kControlSwitchOn,
                                    cia402::kControlEnableOperation, cia402::kFaultReset};

DriveStateMachine machine_in(State state) {
  DriveStateMachine machine;
  if (state == State::kNotReadyToSwitchOn) return machine;
  machine.initialised();
  if (state == State::kFault) machine.fault();
  if (state == State::kSwitchOnDisabled || state == State::kFault) return machine;
  machine.command(cia402::kControlShutdown);
  if (state == State::kReadyToSwitchOn) return machine;
  machine.command(cia402::kControlSwitchOn);
  if (state == State::kSwitchedOn) return machine;
  machine.command(cia402::kControlEnableOperation);
  if (state == State::kQuickStopActive) machine.command(cia402::kControlQuickStop);
  if (state == State::kFaultReactionActive) machine.fault();
  return machine;
}

// CiA 402-2, figure 5 and table 27, with the numbers of the transitions. Rows: states in the order of
// kStates; columns: disable voltage, quick stop, shutdown, switch on, enable operation, fault reset.
TEST(DriveStateMachine, FollowsEveryCommandFromEveryStateAsCia402Specifies) {
  using enum State;
  constexpr State kNext[8][6] = {
      {kNotReadyToSwitchOn, kNotReadyToSwitchOn, kNotReadyToSwitchOn, kNotReadyToSwitchOn,
       kNotReadyToSwitchOn, kNotReadyToSwitchOn},
      {kSwitchOnDisabled, kSwitchOnDisabled, kReadyToSwitchOn /*2*/, kSwitchOnDisabled, kSwitchOnDisabled,
       kSwitchOnDisabled},
      {kSwitchOnDisabled /*7*/, kSwitchOnDisabled /*7*/, kReadyToSwitchOn, kSwitchedOn /*3*/,
       kOperationEnabled /*3, 4*/, kSwitchOnDisabled /*7*/},
      {kSwitchOnDisabled /*10*/, kSwitchOnDisabled /*10*/, kReadyToSwitchOn /*6*/, kSwitchedOn,
       kOperationEnabled /*4*/, kSwitchOnDisabled /*10*/},
      {kSwitchOnDisabled /*9*/, kQuickStopActive /*11*/, kReadyToSwitchOn /*8*/, kSwitchedOn /*5*/,
       kOperationEnabled, kSwitchOnDisabled /*9*/},
      {kSwitchOnDisabled /*12*/, kQuickStopActive, kQuickStopActive, kQuickStopActive, kQuickStopActive,
       kSwitchOnDisabled /*12*/},
      {kFaultReactionActive, kFaultReactionActive, kFaultReactionActive, kFaultReactionActive,
       kFaultReactionActive, kFaultReactionActive},
      {kFault, kFault, kFault, kFault, kFault, kSwitchOnDisabled /*15*/},
  };
  for (std::size_t state = 0; state < std::size(kStates); ++state) {
    for (std::size_t word = 0; word < std::size(kWords); ++word) {
      DriveStateMachine machine = machine_in(kStates[state]);
      ASSERT_EQ(machine.state(), kStates[state]);
      machine.command(kWords[word]);
      EXPECT_EQ(machine.state(), kNext[state][word]) << "state " << state << ", command " << word;
    }
  }
}

// For quick stop option codes 5 to 8.
TEST(DriveStateMachine, ResumesAQuickStopByEnableOperationOnlyIfAllowed) {
  for (const State state : kStates) {
    for (const std::uint16_t word : kWords) {
      DriveStateMachine strict = machine_in(state);
      DriveStateMachine resuming = machine_in(state);
      strict.command(word);
      resuming.command(word, true);
      const bool transition_16 = state == State::kQuickStopActive && word == cia402::kControlEnableOperation;
      EXPECT_EQ(resuming.state(), transition_16 ? State::kOperationEnabled : strict.state());
    }
  }
}

TEST(DriveStateMachine, MakesTorqueInThreeStatesOnly) {
  for (const State state : kStates) {
    const bool expected = state == State::kOperationEnabled || state == State::kQuickStopActive ||
                          state == State::kFaultReactionActive;
    EXPECT_EQ(machine_in(state).makes_torque(), expected);
  }
}

TEST(DriveStateMachine, MakesNoTorqueInAnyStateAfterTheLineFell) {
  for (const State state : kStates) {
    DriveStateMachine machine = machine_in(state);
    machine.torque_off();
    EXPECT_FALSE(machine.makes_torque());
    const bool in_fault = state == State::kFault || state == State::kFaultReactionActive;
    EXPECT_EQ(machine.state() == State::kFault, in_fault);
  }
}

TEST(DriveStateMachine, ReactsToAFaultWithAStopInStatesWithTorque) {
  for (const State state : kStates) {
    DriveStateMachine machine = machine_in(state);
    const bool torque = machine.makes_torque();
    machine.fault();
    EXPECT_EQ(machine.state(), torque ? State::kFaultReactionActive : State::kFault);
    machine.stand_still();
    EXPECT_EQ(machine.state(), State::kFault);
  }
}

TEST(DriveStateMachine, EndsAQuickStopInSwitchOnDisabled) {
  DriveStateMachine machine = machine_in(State::kQuickStopActive);
  machine.stand_still();
  EXPECT_EQ(machine.state(), State::kSwitchOnDisabled);
}

TEST(DriveStateMachine, LeavesAFaultOnlyByTheRisingEdgeOfFaultReset) {
  DriveStateMachine machine = machine_in(State::kOperationEnabled);
  machine.command(cia402::kControlEnableOperation | cia402::kFaultReset);  // held since before the fault
  machine.fault();
  machine.stand_still();
  machine.command(cia402::kControlEnableOperation | cia402::kFaultReset);
  EXPECT_EQ(machine.state(), State::kFault);
  machine.command(0);
  EXPECT_EQ(machine.state(), State::kFault);
  machine.command(cia402::kFaultReset);
  EXPECT_EQ(machine.state(), State::kSwitchOnDisabled);
}

}  // namespace
}  // namespace koboshi::sim_board
