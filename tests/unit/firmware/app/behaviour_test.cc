#include "firmware/behaviour/behaviour.h"

#include <gtest/gtest.h>

#include "tests/support/controller_bench.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;

constexpr State kStates[] = {State::kBoot,      State::kLimp,          State::kEnabling,
                             State::kSoftStart, State::kStanding,      State::kMotion,
                             State::kFault,     State::kEmergencyStop, State::kWalking};

// Brings a new controller into this state by the usual events.
void reach(ControllerBench& bench, State state) {
  bench.run_ms(25);  // the controller is configuring the drives
  if (state == State::kBoot) return;
  if (state == State::kFault || state == State::kEmergencyStop) {
    ASSERT_TRUE(bench.run_until(State::kLimp));
    if (state == State::kFault) bench.board.can.deliver(bench.drives[0].emergency(0xFF01));
    if (state == State::kEmergencyStop) bench.command(Command::kEmergencyStop);
    bench.run_ms(10);
    return;
  }
  ASSERT_TRUE(bench.run_until(State::kLimp));
  if (state == State::kLimp) return bench.run_ms(21);
  if (state == State::kEnabling || state == State::kSoftStart) {
    bench.run_ms(20);
    bench.command(Command::kEnable);
    ASSERT_TRUE(bench.run_until(state));
    return;
  }
  ASSERT_TRUE(bench.run_until_ready_to_walk());
  if (state == State::kMotion) bench.command(Command::kPlay, 1);
  if (state == State::kWalking) bench.command(Command::kWalk);
}

// External events and the actions that cause them in the test. All other events occur without an action.
struct Cause {
  Event event;
  void (*apply)(ControllerBench&);
};
constexpr Cause kCauses[] = {
    {Event::kEnable, [](ControllerBench& bench) { bench.command(Command::kEnable); }},
    {Event::kLimp, [](ControllerBench& bench) { bench.command(Command::kLimp); }},
    {Event::kPlay, [](ControllerBench& bench) { bench.command(Command::kPlay, 1); }},
    {Event::kWalk, [](ControllerBench& bench) { bench.command(Command::kWalk); }},
    {Event::kReset, [](ControllerBench& bench) { bench.command(Command::kReset); }},
    {Event::kEmergencyStop, [](ControllerBench& bench) { bench.command(Command::kEmergencyStop); }},
    {Event::kFailure,
     [](ControllerBench& bench) {
       bench.board.can.set_error_state(hal::CanErrorState::kBusOff);
       bench.run_ms(Controller::kTick_us / 1'000);
     }},
};

class BehaviourIn : public testing::TestWithParam<State> {};

TEST_P(BehaviourIn, ChangesOnlyAsTheTransitionTableStates) {
  for (const Cause& cause : kCauses) {
    SCOPED_TRACE("event " + std::to_string(static_cast<int>(cause.event)));
    ControllerBench bench;
    reach(bench, GetParam());
    ASSERT_EQ(bench.now().state, GetParam());
    while (bench.now_us() % Controller::kTick_us == 0)
      bench.run_ms(1);  // no progress event in the same millisecond
    cause.apply(bench);
    EXPECT_EQ(bench.now().state, next_state(GetParam(), cause.event).value_or(GetParam()));
  }
}

TEST_P(BehaviourIn, HasTheLineHighOnlyWhereTorqueIsAllowed) {
  ControllerBench bench;
  reach(bench, GetParam());
  EXPECT_EQ(bench.board.drive_enable.enabled(), behaviour::kTorque.contains(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(EveryState, BehaviourIn, testing::ValuesIn(kStates), [](const auto& info) {
  return "State" + std::to_string(static_cast<int>(info.param));
});

TEST(Behaviour, ProgressesFromBootToTheEndOfAMotion) {
  ControllerBench bench;
  ASSERT_TRUE(bench.run_until(State::kLimp));  // kReady
  bench.run_ms(20);
  bench.command(Command::kEnable);
  ASSERT_TRUE(bench.run_until(State::kSoftStart));  // kEnabled
  ASSERT_TRUE(bench.run_until(State::kStanding));   // kArrived
  bench.command(Command::kPlay, 0);
  ASSERT_EQ(bench.now().state, State::kMotion);
  ASSERT_TRUE(bench.run_until(State::kStanding, 600));  // kEnded
  EXPECT_EQ(bench.now().reason, Reason::kProgress);
}

}  // namespace
}  // namespace koboshi::app
