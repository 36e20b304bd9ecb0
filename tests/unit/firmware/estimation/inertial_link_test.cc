// An inertial unit in the head of the test robot: behind the joints of pan (about z) and tilt (about y).

#include "firmware/estimation/inertial_link.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include "firmware/fixed/host/convert.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

using fixed::Angle;
using fixed::to_double;

constexpr std::size_t kPan = 18;
constexpr std::size_t kTilt = test::kHeadTilt;
constexpr double kTurn_rad = 2.0 * std::numbers::pi;

class InertialLinkTest : public testing::Test {
 protected:
  InertialLinkTest() { model_.imu_link = robot::LinkIndex(robot::JointIndex(kTilt)); }

  void update() { link_->update(std::span(angles_).first(model_.joint_count)); }
  // Turns a joint by this angle in one cycle.
  void turn(std::size_t joint, std::int32_t by_raw) {
    angles_[joint] = angles_[joint] + Angle::from_raw(by_raw);
    update();
  }
  void expect_rates(double x, double y, double z, double tolerance) const {
    EXPECT_NEAR(to_double(link_->w_BL_B().x), x, tolerance);
    EXPECT_NEAR(to_double(link_->w_BL_B().y), y, tolerance);
    EXPECT_NEAR(to_double(link_->w_BL_B().z), z, tolerance);
  }

  robot::RobotModel model_ = test::make_test_robot();
  std::array<Angle, robot::kMaxJoints> angles_{};
  std::optional<InertialLink> link_{std::in_place, model_};
};

TEST_F(InertialLinkTest, TellsWhetherItIsTheTrunk) {
  EXPECT_FALSE(link_->is_trunk());
  model_.imu_link = {};
  EXPECT_TRUE(link_->is_trunk());
}

TEST_F(InertialLinkTest, HasNoSpeedInItsFirstCycle) {
  turn(kPan, 1 << 28);
  EXPECT_EQ(link_->w_BL_B(), InertialLink::Rates());
  EXPECT_NE(link_->R_BL(), robot::Rotation());
}

// 2^20 raw in 10 ms are 100 * 2^20 / 2^8 raw of a rate. It is halved with the last speed: 1/2, 3/4, 7/8.
TEST_F(InertialLinkTest, HalvesEachSpeedWithTheLast) {
  update();
  constexpr std::int32_t kRate_raw = 100 << 12;
  for (const std::int32_t eighths : {4, 6, 7}) {
    turn(kPan, 1 << 20);
    EXPECT_EQ(link_->w_BL_B().z.raw(), kRate_raw / 8 * eighths);
    EXPECT_EQ(link_->w_BL_B().x.raw(), 0);
    EXPECT_EQ(link_->w_BL_B().y.raw(), 0);
  }
  update();
  EXPECT_EQ(link_->w_BL_B().z.raw(), kRate_raw / 16 * 7);
}

TEST_F(InertialLinkTest, FollowsAJointThroughHalfATurn) {
  angles_[kPan] = Angle::from_raw(std::numeric_limits<std::int32_t>::max() - (1 << 19));
  update();
  turn(kPan, 1 << 20);
  EXPECT_LT(angles_[kPan], Angle());
  EXPECT_EQ(link_->w_BL_B().z.raw(), (100 << 12) / 2);
  turn(kPan, -(1 << 20));
  EXPECT_EQ(link_->w_BL_B().z.raw(), (100 << 12) / 4 - (100 << 12) / 2);
}

// R = R_z(pan) R_y(tilt), w = z pan' + R_z(pan) y tilt'.
TEST_F(InertialLinkTest, AddsTheJointsUpToTheTrunk) {
  std::mt19937 random(431);
  std::uniform_real_distribution<double> angle_rad(-1.0, 1.0);
  std::uniform_real_distribution<double> speed_rad_per_s(-3.0, 3.0);
  for (int trial = 0; trial < 200; ++trial) {
    link_.emplace(model_);
    const double pan_rate = speed_rad_per_s(random);
    const double tilt_rate = speed_rad_per_s(random);
    const auto step = [](double rate_rad_per_s) {
      return static_cast<std::int32_t>(std::lround(0.01 * rate_rad_per_s / kTurn_rad * std::exp2(32)));
    };
    angles_[kPan] = fixed::from_double<Angle>(angle_rad(random));
    angles_[kTilt] = fixed::from_double<Angle>(angle_rad(random));
    angles_[0] = fixed::from_double<Angle>(angle_rad(random));  // a leg, which is not on the way
    for (int cycle = 0; cycle < 40; ++cycle) {
      angles_[0] = angles_[0] + Angle::from_raw(1 << 24);
      angles_[kPan] = angles_[kPan] + Angle::from_raw(step(pan_rate));
      turn(kTilt, step(tilt_rate));
    }
    const double p = to_double(angles_[kPan]);
    const double t = to_double(angles_[kTilt]);
    const std::array<std::array<double, 3>, 3> expected{
        {{std::cos(p) * std::cos(t), -std::sin(p), std::cos(p) * std::sin(t)},
         {std::sin(p) * std::cos(t), std::cos(p), std::sin(p) * std::sin(t)},
         {-std::sin(t), 0, std::cos(t)}}};
    for (std::size_t row = 0; row < 3; ++row) {
      const robot::Direction& found = link_->R_BL().rows[row];
      EXPECT_NEAR(to_double(found.x), expected[row][0], 1e-7);
      EXPECT_NEAR(to_double(found.y), expected[row][1], 1e-7);
      EXPECT_NEAR(to_double(found.z), expected[row][2], 1e-7);
    }
    expect_rates(-std::sin(p) * tilt_rate, std::cos(p) * tilt_rate, pan_rate, 2e-6);
  }
}

TEST_F(InertialLinkTest, RequiresAnAngleOfEveryJoint) {
  EXPECT_DEATH(link_->update(std::span(angles_).first(model_.joint_count - 1)), "joint_count");
}

}  // namespace
}  // namespace koboshi::estimation
