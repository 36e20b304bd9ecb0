#include "firmware/robot/kinematics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>

#include "firmware/fixed/trigonometry.h"
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

// Rodrigues' formula, as for any axis.
Rotation rodrigues(const Direction& a, fixed::Angle angle) {
  using fixed::product;
  using fixed::Ratio;
  const auto [s, c] = fixed::sin_cos(angle);
  const auto scaled = [](Ratio factor, const Direction& v) {
    return Direction{product<Ratio>(factor, v.x), product<Ratio>(factor, v.y), product<Ratio>(factor, v.z)};
  };
  const Direction sa = scaled(s, a);
  const Direction va = scaled(fixed::kOne - c, a);
  return {{Direction{c, -sa.z, sa.y} + scaled(va.x, a), Direction{sa.z, c, -sa.x} + scaled(va.y, a),
           Direction{-sa.y, sa.x, c} + scaled(va.z, a)}};
}

int largest_difference_raw(const Rotation& a, const Rotation& b) {
  int largest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Direction difference = a.rows[i] - b.rows[i];
    for (const fixed::Ratio each : {difference.x, difference.y, difference.z})
      largest = std::max(largest, std::abs(each.raw()));
  }
  return largest;
}

TEST_F(KinematicsTest, TurnsAboutAxesOfTheBaseByTheSameBitsAsAProduct) {
  const auto draw = [&] { return fixed::Angle::from_raw(static_cast<std::int32_t>(random_()) / 8 * 7); };
  for (int round = 0; round < 5000; ++round) {
    const Rotation R = rodrigues(kAxisX, draw()) * rodrigues(kAxisY, draw()) * rodrigues(kAxisZ, draw());
    for (const Direction& axis : {kAxisX, kAxisY, kAxisZ, -kAxisX, -kAxisY, -kAxisZ}) {
      const fixed::Angle angle = draw();
      const Rotation turn = rodrigues(axis, angle);
      ASSERT_EQ(rotation_about(axis, angle), turn) << "seed " << kKinematicsSeed << ", round " << round;
      Rotation turned = R;
      const Direction R_axis = turn_about(turned, axis, angle);
      ASSERT_EQ(turned, R * turn) << "seed " << kKinematicsSeed << ", round " << round;
      ASSERT_EQ(R_axis, R * axis) << "seed " << kKinematicsSeed << ", round " << round;
    }
  }
}

// Three roundings of a product with a rotation matrix, and two without it.
TEST_F(KinematicsTest, TurnsAboutObliqueAxesLikeAProduct) {
  const auto draw = [&] { return fixed::Angle::from_raw(static_cast<std::int32_t>(random_())); };
  const auto ratio = [](double value) { return fixed::from_double<fixed::Ratio>(value); };
  int worst_raw = 0;
  for (int round = 0; round < 5000; ++round) {
    const Rotation R = rodrigues(kAxisX, draw()) * rodrigues(kAxisY, draw()) * rodrigues(kAxisZ, draw());
    std::uniform_real_distribution<> uniform(-1, 1);
    const Point v{uniform(random_), uniform(random_), uniform(random_)};
    const Direction axis{ratio(v.x / norm(v)), ratio(v.y / norm(v)), ratio(v.z / norm(v))};
    const fixed::Angle angle = draw();
    Rotation turned = R;
    static_cast<void>(turn_about(turned, axis, angle));
    worst_raw = std::max(worst_raw, largest_difference_raw(turned, R * rotation_about(axis, angle)));
  }
  EXPECT_LT(worst_raw, 8) << "seed " << kKinematicsSeed;
  EXPECT_GT(worst_raw, 0) << "seed " << kKinematicsSeed;
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
