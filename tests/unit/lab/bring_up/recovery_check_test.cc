#include "lab/bring_up/recovery_check.h"

#include <gtest/gtest.h>

#include <filesystem>

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

TEST(RecoveryCheck, SlowsDownJointsThatTurnTooFast) {
  const std::filesystem::path koboshi = kRobots / "koboshi/robot.sdf";
  const sim_board::RobotDescription robot = sim_board::load_robot(koboshi);
  RecoveryCheck check(koboshi);
  const std::vector<std::pair<std::string, double>> standing{{"left_knee", 40.0}, {"right_knee", 40.0}};
  const RecoveryMotion motion = RecoveryMotion::retarget("rise_prone", koboshi, robot, standing, 1.0);
  EXPECT_TRUE(check.errors(motion).empty());
  const RecoveryMotion fast = motion.with_step_slower_by(1, 0.2);
  ASSERT_FALSE(check.errors(fast).empty());
  EXPECT_EQ(check.errors(fast).front().substr(0, 5), "C001,");
  EXPECT_TRUE(check.errors(check.mended(fast)).empty());
}

}  // namespace
}  // namespace koboshi::lab
