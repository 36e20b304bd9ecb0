#include "firmware/estimation/posture.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/firmware/estimation/random_posture.h"

namespace koboshi::estimation {
namespace {

using test::Point;
using test::RandomPosture;
using test::to_point;

constexpr std::array kSides{hal::Side::kLeft, hal::Side::kRight};

TEST(Posture, FindsSolesAndCentreOfMassAsDoublePrecisionDoes) {
  RandomPosture robot;
  double worst_sole_m = 0.0;
  double worst_com_m = 0.0;
  double worst_axis = 0.0;
  for (int round = 0; round < 2000; ++round) {
    robot.draw();
    for (const hal::Side side : kSides) {
      const robot::Pose& X_BSole = robot.posture.X_BSole[side];
      const robot::Rotation R_SoleB = robot::transpose(X_BSole.R);
      const Point origin = robot.from_sole(side, {});
      worst_sole_m = std::max(worst_sole_m, norm(to_point(X_BSole.p) - origin));
      const std::array<Point, 3> units{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Point expected = robot.from_sole(side, units[axis]) - origin;
        worst_axis = std::max(worst_axis, norm(to_point(R_SoleB.rows[axis]) - expected));
      }
      const Point com_S = robot.to_sole(side, robot.com_B());
      worst_com_m = std::max(worst_com_m, norm(to_point(robot.posture.centre_of_mass(side)) - com_S));
    }
  }
  EXPECT_LT(worst_sole_m, 0.3e-6);
  EXPECT_LT(worst_com_m, 1e-6);
  EXPECT_LT(worst_axis, 1e-8);
  EXPECT_GT(worst_com_m, 1e-9);
}

TEST(Posture, IsInvalidWithoutAModel) {
  const Posture posture = posture_at(robot::RobotModel(), {});
  EXPECT_EQ(posture.centre_of_mass(hal::Side::kRight), robot::Position{});
}

}  // namespace
}  // namespace koboshi::estimation
