#include "firmware/robot/kinematics.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/unit/firmware/robot/reference.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::robot {
namespace {

using test::Point;
using test::to_base;
using test::to_point;

constexpr std::uint32_t kKinematicsSeed = 4711;

class KinematicsTest : public testing::Test {
 protected:
  void SetUp() override {
    RecordProperty("seed", static_cast<int>(kKinematicsSeed));
    RobotModel written = test::make_test_robot();
    // An oblique axis for the arms' roll, because the default robot's joints all use principal axes.
    written.joints[13].axis = written.joints[16].axis = {
        fixed::from_double<fixed::Ratio>(0.6), {}, fixed::from_double<fixed::Ratio>(0.8)};
    ASSERT_EQ(load_model(test::encode(written), model_), ModelStatus::kOk);
  }

  void draw_angles() {
    for (std::size_t i = 0; i < model_.joint_count; ++i) {
      const std::int64_t lower_raw = model_.joints[i].lower.raw();
      const auto range = static_cast<std::uint64_t>(model_.joints[i].upper.raw() - lower_raw) + 1;
      const std::uint64_t draw = (std::uint64_t{random_()} << 32 | random_()) % range;
      angles_[i] = fixed::Angle::from_wide_raw(lower_raw + static_cast<std::int64_t>(draw));
      angles_rad_[i] = fixed::to_double(angles_[i]);
    }
  }

  RobotModel model_;
  std::mt19937 random_{kKinematicsSeed};
  std::array<fixed::Angle, kMaxJoints> angles_{};
  std::array<double, kMaxJoints> angles_rad_{};
  LinkPoses X_BLinks_;
};

TEST_F(KinematicsTest, AgreesWithDoubleInEveryLink) {
  double worst_m = 0.0;
  double worst_direction = 0.0;
  for (int round = 0; round < 5000; ++round) {
    draw_angles();
    forward_kinematics(model_, angles_, X_BLinks_);
    for (std::size_t i = 0; i < model_.joint_count; ++i) {
      const int joint = static_cast<int>(i);
      const Point expected = to_base(model_, angles_rad_, joint, {0, 0, 0});
      worst_m = std::max(worst_m, norm(to_point(X_BLinks_[i].p) - expected));
      const Rotation R_LinkB = transpose(X_BLinks_[i].R);
      const std::array<Point, 3> units{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Point direction = to_base(model_, angles_rad_, joint, units[axis], true);
        worst_direction = std::max(worst_direction, norm(to_point(R_LinkB.rows[axis]) - direction));
      }
    }
  }
  EXPECT_LT(worst_m, 0.5e-6) << "seed " << kKinematicsSeed;
  EXPECT_LT(worst_direction, 2e-8) << "seed " << kKinematicsSeed;
  EXPECT_GT(worst_m, 1e-9);
}

TEST_F(KinematicsTest, FindsTheCentreOfMass) {
  double worst_m = 0.0;
  for (int round = 0; round < 2000; ++round) {
    draw_angles();
    forward_kinematics(model_, angles_, X_BLinks_);
    double mass_kg = fixed::to_double(model_.base_mass);
    Point moment = mass_kg * to_point(model_.base_centre_of_mass);
    for (std::size_t i = 0; i < model_.joint_count; ++i) {
      const double link_kg = fixed::to_double(model_.joints[i].mass);
      const Point centre =
          to_base(model_, angles_rad_, static_cast<int>(i), to_point(model_.joints[i].centre_of_mass));
      moment = moment + link_kg * centre;
      mass_kg += link_kg;
    }
    worst_m = std::max(worst_m, norm(to_point(centre_of_mass(model_, X_BLinks_)) - (1.0 / mass_kg) * moment));
  }
  EXPECT_LT(worst_m, 0.5e-6) << "seed " << kKinematicsSeed;
}

TEST_F(KinematicsTest, PutsTheSoleBelowTheAnkleAtJointZero) {
  angles_ = {};
  forward_kinematics(model_, angles_, X_BLinks_);
  const Point left = to_point(sole_pose(model_, hal::Side::kLeft, X_BLinks_).p);
  const Point right = to_point(sole_pose(model_, hal::Side::kRight, X_BLinks_).p);
  EXPECT_NEAR(left.x, 0.0, 1e-7);
  EXPECT_NEAR(left.y, 0.03, 1e-7);
  EXPECT_NEAR(left.z, -0.17, 2e-7);
  EXPECT_NEAR(right.y, -0.03, 1e-7);
}

}  // namespace
}  // namespace koboshi::robot
