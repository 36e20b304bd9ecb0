#include "lab/bring_up/recovery_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/description/load.h"

namespace koboshi::lab {
namespace {

const std::filesystem::path kRobots = std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots";

// A motion of the default robot for a larger one, whose feet meet below folded legs and whose thighs meet the
// trunk.
TEST(RecoveryCheck, MendsFeetThatMeetAndThighsInTheTrunk) {
  const std::filesystem::path noppo = kRobots / "noppo/robot.sdf";
  const sim_board::RobotDescription robot = sim_board::load_robot(noppo);
  const std::vector<std::pair<std::string, double>> standing{{"left_knee", 60.0}, {"right_knee", 60.0}};
  RecoveryCheck check(noppo);
  for (const char* name : {"rise_prone", "rise_supine"}) {
    const RecoveryMotion motion =
        RecoveryMotion::retarget(name, kRobots / "koboshi/robot.sdf", robot, standing, 1.7);
    EXPECT_FALSE(check.errors(motion).empty()) << name;
    const RecoveryMotion mended = check.mended(motion);
    EXPECT_TRUE(check.errors(mended).empty()) << name << ": " << check.errors(mended).front();
    EXPECT_EQ(check.mended(mended).text("Origin"), mended.text("Origin")) << name;
  }
}

// The compiler refuses a move that is too fast between two poses of a motion; the check knows where it
// begins.
TEST(RecoveryCheck, SlowsDownJointsThatTurnTooFast) {
  const std::filesystem::path koboshi = kRobots / "koboshi/robot.sdf";
  const sim_board::RobotDescription robot = sim_board::load_robot(koboshi);
  std::vector<std::pair<std::string, double>> standing;  // motions/stand.yaml
  for (const char* side : {"left_", "right_"})
    for (const auto& [joint, angle_deg] : {std::pair("hip_pitch", -15.9), std::pair("knee", 43.72),
                                           std::pair("ankle_pitch", -27.82), std::pair("elbow", -20.0)})
      standing.emplace_back(side + std::string(joint), angle_deg);
  RecoveryCheck check(koboshi);
  const RecoveryMotion motion = RecoveryMotion::retarget("rise_prone", koboshi, robot, standing, 1.0);
  const auto too_fast = [&](const RecoveryMotion& any) {
    return std::ranges::count_if(check.errors(any),
                                 [](const std::string& error) { return error.starts_with("C001"); });
  };
  EXPECT_EQ(too_fast(motion), 0);
  const RecoveryMotion fast = motion.with_step_slower_by(1, 0.75);
  EXPECT_EQ(too_fast(fast), 2);  // the shoulders
  EXPECT_EQ(too_fast(check.mended(fast)), 0);
}

}  // namespace
}  // namespace koboshi::lab
