#include "tools/teleop/status.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tools/teleop/map.h"

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
  status.place = {1.25, -0.4, 0.5 * std::numbers::pi};
  status.last_key = "forward";
  status.effect = "walk, 0.10 m/s forward";
  status.last_command = "walk, 0.10 m/s forward: obeyed";
  status.last_event = "Walks.";
  return status;
}

TEST(TeleopStatus, ShowsTheActivityOfTheRobot) {
  const auto lines = status_lines(walking());
  EXPECT_THAT(lines, Contains("koboshi, driven by keys: scenarios/teleop.yaml"));
  EXPECT_THAT(lines, Contains("time        12.34 s, 1.00 x real time, 3 overruns, 4 ms at most"));
  EXPECT_THAT(lines, Contains("state       walking, by command"));
  EXPECT_THAT(lines, Contains("commanded   ahead +0.10 m/s, left +0.00 m/s, turn -0.20 rad/s"));
  EXPECT_THAT(lines, Contains("measured    ahead +0.09 m/s, left +0.01 m/s, turn -0.19 rad/s"));
  EXPECT_THAT(lines, Contains("place       x +1.25 m, y -0.40 m, heading +90 degrees"));
  EXPECT_THAT(lines, Contains("attitude    roll +1.0, pitch +0.0 degrees"));
  EXPECT_THAT(lines, Contains("ZMP         +12, -3 mm on the right sole, true margin 8 mm"));
  EXPECT_THAT(lines, Contains("CoM         +1, +20, +200 mm from there"));
  EXPECT_THAT(lines, Contains("load        left 1.2 N, right 10.5 N"));
  EXPECT_THAT(lines, Contains("supply      7.40 V at the lowest drive"));
  EXPECT_THAT(lines, Contains("push        0.20 N s"));
  EXPECT_THAT(lines, Contains("last key    forward: walk, 0.10 m/s forward"));
  EXPECT_THAT(lines, Contains("command     walk, 0.10 m/s forward: obeyed"));
  EXPECT_THAT(lines, Contains("event       Walks."));
}

TEST(TeleopStatus, ShowsErrors) {
  TeleopStatus status = walking();
  status.bus = "slcan:/dev/pts/3";
  status.held = true;
  status.falls = 2;
  status.aims = true;
  status.said.state = behaviour::State::kFault;
  status.said.reason = behaviour::Reason::kDriveFault;
  status.said.drive_fault = drive::DriveFault::kLost;
  status.said.zmp = {};
  EXPECT_THAT(status_lines(status), Contains("state       fault, by drive fault, drive lost"));
  EXPECT_THAT(status_lines(status), Contains(HasSubstr("CAN bus on slcan:/dev/pts/3")));
  EXPECT_THAT(status_lines(status), Contains(HasSubstr("held by the stand, 2 falls")));
  EXPECT_THAT(status_lines(status), Contains("ZMP         none: no foot carries enough"));
  EXPECT_THAT(status_lines(status), Contains("push        0.20 N s, where to?"));
}

TEST(TeleopStatus, NeverShowsALyingRobotAsStanding) {
  TeleopStatus status = walking();
  status.tilt_rad = 1.4;
  for (const behaviour::State state :
       {behaviour::State::kStanding, behaviour::State::kWalking, behaviour::State::kMotion,
        behaviour::State::kLowBattery, behaviour::State::kSoftStart}) {
    status.said.state = state;
    EXPECT_THAT(status_lines(status), Contains("state       LIES; its controller has not noticed"));
    EXPECT_THAT(status_lines(status), Not(Contains(HasSubstr("standing"))));
  }
  status.said.state = behaviour::State::kRising;
  status.said.reason = behaviour::Reason::kProne;
  EXPECT_THAT(status_lines(status), Contains("state       LIES; rising, by prone"));
  status.tilt_rad = 0.8;
  EXPECT_THAT(status_lines(status), Contains("state       leans by 46 degrees; rising, by prone"));
  status.said.state = behaviour::State::kStanding;
  EXPECT_THAT(status_lines(status), Not(Contains(HasSubstr("standing"))));
}

TEST(TeleopStatus, ShowsTheMapBesideTheNumbers) {
  TeleopStatus status = walking();
  TrailMap map;
  map.move_to(Eigen::Vector3d::Zero());
  status.map = map.lines(false);
  const auto lines = status_lines(status);
  EXPECT_EQ(lines[2].substr(61), "+-----------------+");
  EXPECT_EQ(lines[3], "state       walking, by command                              |                 |");
  EXPECT_EQ(lines[7].substr(61), "|        ^        |");
  EXPECT_EQ(lines[12].substr(61), "+- 17 x 0.1 m ----+");
  EXPECT_LE(lines.size(), 24u);
}

TEST(TeleopStatus, AlwaysFitsTheScreen) {
  TeleopStatus status = walking();
  status.scenario.assign(200, 'x');
  const auto lines = status_lines(status);
  EXPECT_LE(lines.size(), 24u);
  EXPECT_THAT(lines, Not(Contains(SizeIs(testing::Gt(80u)))));
  EXPECT_EQ(status_lines(TeleopStatus{}).size(), lines.size());
  EXPECT_THAT(status_lines(walking()), Not(Contains(SizeIs(testing::Ge(80u))))) << "a line was cut";
}

TEST(Screen, PlacesEachLineAndNeverScrolls) {
  EXPECT_EQ(screen_of({"one", "", "three"}, 24),
            "\x1B[1;1Hone\x1B[K\x1B[2;1H\x1B[K\x1B[3;1Hthree\x1B[K\x1B[J");
  EXPECT_EQ(screen_of({"one", "two"}, 1), "\x1B[1;1Hone\x1B[K\x1B[J");
}

}  // namespace
}  // namespace koboshi::tools
