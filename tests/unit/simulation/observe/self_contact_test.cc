#include "simulation/observe/self_contact.h"

#include <gtest/gtest.h>

#include "sim_board/board/sim_board.h"
#include "sim_board/description/load.h"
#include "tests/unit/simulation/observe/staged_world.h"

namespace koboshi::simulation {
namespace {

constexpr int kTicks = SelfContacts::kReported_us / sim_board::SimBoard::kTick_us;

class SelfContactsTest : public testing::Test {
 protected:
  int link(const char* name) const { return robot_.find_link(name).value(); }
  std::size_t joint(const char* name) const {
    return static_cast<std::size_t>(robot_.find_joint(name).value());
  }
  // Observes this many ticks, of which only the last one may report.
  std::optional<SelfContact> observe(int ticks) {
    for (int i = 1; i < ticks; ++i) EXPECT_FALSE(contacts_.observe(world_, said_)) << i;
    return contacts_.observe(world_, said_);
  }

  const sim_board::RobotDescription robot_ =
      sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  StagedWorld world_{robot_};
  Telemetry said_;
  SelfContacts contacts_{robot_};
};

TEST_F(SelfContactsTest, ReportsTheJointBetweenTheLinksThatIsFurthestFromItsTarget) {
  world_.touch(link("left_thigh"), 0);
  world_.touch(link("left_thigh"), 0);  // at two points
  said_.joints[joint("left_hip_roll")].target_rad = 0.02;
  said_.joints[joint("left_hip_pitch")] = {.target_rad = -0.5, .position_rad = -0.4};
  said_.joints[joint("left_knee")].target_rad = 1.0;  // beyond the thigh
  said_.joints[joint("right_hip_pitch")].target_rad = 1.0;
  const auto contact = observe(kTicks);
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->link, 0);
  EXPECT_EQ(contact->other_link, link("left_thigh"));
  EXPECT_EQ(contact->joint, static_cast<int>(joint("left_hip_pitch")));
  EXPECT_NEAR(contact->following_error_rad, 0.1, 1e-12);
}

TEST_F(SelfContactsTest, ReportsAPairOnce) {
  world_.touch(0, link("left_thigh"));
  EXPECT_TRUE(observe(kTicks));
  EXPECT_FALSE(observe(3 * kTicks));
}

TEST_F(SelfContactsTest, AddsUpInterruptedContacts) {
  world_.touch(0, link("left_thigh"));
  EXPECT_FALSE(observe(kTicks - 1));
  world_.unload();
  EXPECT_FALSE(observe(kTicks));
  world_.touch(0, link("left_thigh"));
  EXPECT_TRUE(observe(1));
}

TEST_F(SelfContactsTest, ReportsPairsOneAfterTheOther) {
  world_.touch(0, link("left_thigh"));
  world_.touch(0, link("right_thigh"));
  const auto first = observe(kTicks);
  const auto second = observe(1);
  ASSERT_TRUE(first && second);
  EXPECT_NE(first->other_link, second->other_link);
  EXPECT_FALSE(observe(kTicks));
}

TEST_F(SelfContactsTest, IgnoresTheGround) {
  world_.load(link("left_thigh"), 10.0);
  EXPECT_FALSE(observe(2 * kTicks));
}

TEST_F(SelfContactsTest, ReportsTwoLegsByAJointOfEitherLeg) {
  world_.touch(link("left_thigh"), link("right_thigh"));
  said_.joints[joint("right_hip_roll")].target_rad = 0.2;
  said_.joints[joint("left_shoulder_pitch")].target_rad = 1.0;
  const auto contact = observe(kTicks);
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->joint, static_cast<int>(joint("right_hip_roll")));
  EXPECT_NEAR(contact->following_error_rad, -0.2, 1e-12);
}

}  // namespace
}  // namespace koboshi::simulation
