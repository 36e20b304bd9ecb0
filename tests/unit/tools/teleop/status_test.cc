#include "tools/teleop/status.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace koboshi::tools {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

TeleopStatus walking() {
  TeleopStatus status;
  status.scenario = "scenarios/teleop.yaml";
  status.simulated_s = 12.34;
  status.real_time_factor = 0.998;
  status.overruns = 3;
  status.largest_delay_us = 4'999;
  status.said.state = behaviour::State::kWalking;
  status.said.reason = behaviour::Reason::kCommand;
  status.said.roll_rad = 0.0174533;
  status.said.zmp = {.x_m = 0.012, .y_m = -0.003, .valid = true, .frame = hal::Side::kRight};
  status.said.com_S_m = {0.001, 0.02, 0.2};
  status.said.foot_load_N = {1.25, 10.5};
  status.commanded = {.forward_m_per_s = 0.1, .left_m_per_s = 0.0, .turn_rad_per_s = -0.2};
  status.measured = {.forward_m_per_s = 0.09, .left_m_per_s = 0.01, .turn_rad_per_s = -0.19};
  status.zmp_margin_m = 0.008;
  status.supply_V = 7.4;
  status.push_N_s = 0.2;
  status.last_key = "forward";
  return status;
}

TEST(TeleopStatus, TellsWhatTheRobotDoes) {
  const auto lines = status_lines(walking());
  EXPECT_THAT(lines, Contains("koboshi, driven by keys: scenarios/teleop.yaml"));
  EXPECT_THAT(lines, Contains("time        12.34 s, 1.00 x real time, 3 overruns, 4 ms at most"));
  EXPECT_THAT(lines, Contains("state       walking, by command"));
  EXPECT_THAT(lines, Contains("commanded   ahead +0.10 m/s, left +0.00 m/s, turn -0.20 rad/s"));
  EXPECT_THAT(lines, Contains("measured    ahead +0.09 m/s, left +0.01 m/s, turn -0.19 rad/s"));
  EXPECT_THAT(lines, Contains("attitude    roll +1.0, pitch +0.0, true yaw +0 degrees"));
  EXPECT_THAT(lines, Contains("ZMP         +12, -3 mm on the right sole, true margin 8 mm"));
  EXPECT_THAT(lines, Contains("CoM         +1, +20, +200 mm from there"));
  EXPECT_THAT(lines, Contains("load        left 1.2 N, right 10.5 N"));
  EXPECT_THAT(lines, Contains("supply      7.40 V at the lowest drive"));
  EXPECT_THAT(lines, Contains("push        0.20 N s"));
  EXPECT_THAT(lines, Contains("last key    forward"));
}

TEST(TeleopStatus, TellsWhatIsAmiss) {
  TeleopStatus status = walking();
  status.bus = "slcan:/dev/pts/3";
  status.held = true;
  status.fell = true;
  status.aims = true;
  status.said.state = behaviour::State::kFault;
  status.said.reason = behaviour::Reason::kDriveTrouble;
  status.said.trouble = drive::Trouble::kLost;
  status.said.zmp = {};
  EXPECT_THAT(status_lines(status), Contains("state       fault, by drive trouble, drive lost"));
  EXPECT_THAT(status_lines(status), Contains(HasSubstr("CAN bus on slcan:/dev/pts/3")));
  EXPECT_THAT(status_lines(status), Contains(HasSubstr("held by the stand, has fallen")));
  EXPECT_THAT(status_lines(status), Contains("ZMP         none: no foot carries enough"));
  EXPECT_THAT(status_lines(status), Contains("push        0.20 N s, where to?"));
  status = walking();
  status.said.refusal = behaviour::Reason::kNotInThisState;
  EXPECT_THAT(status_lines(status), Contains(HasSubstr("last command refused: not in this state")));
}

TEST(TeleopStatus, FitsAScreenWhateverItTells) {
  TeleopStatus status = walking();
  status.scenario.assign(200, 'x');
  const auto lines = status_lines(status);
  EXPECT_LE(lines.size(), 24u);
  EXPECT_THAT(lines, Not(Contains(SizeIs(testing::Gt(80u)))));
  EXPECT_EQ(status_lines(TeleopStatus{}).size(), lines.size());
  EXPECT_THAT(status_lines(walking()), Not(Contains(SizeIs(testing::Ge(80u))))) << "a line was cut";
}

TEST(Screen, PutsEachLineInItsPlaceAndNeverScrolls) {
  EXPECT_EQ(screen_of({"one", "", "three"}, 24),
            "\x1B[1;1Hone\x1B[K\x1B[2;1H\x1B[K\x1B[3;1Hthree\x1B[K\x1B[J");
  EXPECT_EQ(screen_of({"one", "two"}, 1), "\x1B[1;1Hone\x1B[K\x1B[J");
}

}  // namespace
}  // namespace koboshi::tools
