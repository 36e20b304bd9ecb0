#include <gtest/gtest.h>

#include "firmware/app/controller.h"
#include "hal/fake/board.h"

namespace koboshi::app {
namespace {

// Calls the controller as a board does: `service` each millisecond, `tick` after each tenth call.
void run(Controller& controller, std::uint64_t from_us, std::uint64_t to_us) {
  for (std::uint64_t now_us = from_us; now_us < to_us; now_us += 1'000) {
    controller.service(now_us);
    if (now_us % Controller::kTick_us == 0) controller.tick(now_us);
  }
}

TEST(ControllerExample, RefusesToEnableWithoutARobotModel) {
  hal::FakeBoard board;  // its storage is erased
  Controller controller(board.ports());
  run(controller, 0, 100'000);

  // An SDO write of 1, the command "enable", to object 0x2000, sub-index 1 (CiA 301, 7.2.4.3.3).
  board.can.deliver({.identifier = 0x601, .size = 8, .data = {0x2F, 0x00, 0x20, 0x01, 0x01}});
  run(controller, 100'000, 200'000);

  // The controller answers with the abort code 0x08000022: not in the present device state.
  const hal::CanFrame refusal{
      .identifier = 0x581, .size = 8, .data = {0x80, 0x00, 0x20, 0x01, 0x22, 0x00, 0x00, 0x08}};
  EXPECT_EQ(board.can.last_sent(0x581), refusal);
  EXPECT_EQ(controller.values().behaviour.state, State::kFault);
  EXPECT_TRUE(board.drive_enable.changes().empty());  // no torque at any time
}

TEST(ControllerExample, FeedsTheWatchdogInEveryService) {
  hal::FakeBoard board;
  Controller controller(board.ports());
  run(controller, 0, 50'000);
  EXPECT_EQ(board.watchdog.kicks(), 50);
  EXPECT_EQ(board.watchdog.last_kick_us(), 49'000u);
}

}  // namespace
}  // namespace koboshi::app
