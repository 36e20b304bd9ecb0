#include "lab/validate/inertial_zmp.h"

#include <gtest/gtest.h>

#include "lab/validate/rigs.h"
#include "sim_board/engine/make_world.h"

namespace koboshi::lab {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(InertialZmp, IsThePointOfTheForceOnAFreeBody) {
  const sim_board::RobotDescription robot = box_rig(1.5, {0.1, 0.06, 0.2});
  sim_board::WorldOptions options;
  options.ground.present = false;
  options.X_WB.translation() = Vector3d(0.1, -0.05, 0.4);
  const auto world = sim_board::make_world(robot, options);
  InertialZmp zmp(robot, kGravity_m_per_s2);
  EXPECT_FALSE(zmp.observe(*world).has_value());
  const Vector3d p_from_W(0.07, 0.02, 0.0);
  for (int i = 0; i < 100; ++i) {
    // Any force whose line passes through the point; not through the centre of mass, so that the body turns.
    const Vector3d p_L(0.01, -0.02, 0.03);
    const Vector3d line = world->body(0).X_WL * p_L - p_from_W;
    world->push(0, p_L, (12.0 + 0.1 * i) / line.z() * line);
    world->step();
    const std::optional<Vector2d> found = zmp.observe(*world);
    ASSERT_TRUE(found.has_value());
    // The inertia turns with the body within the step: of first order.
    EXPECT_NEAR(found->x(), p_from_W.x(), 1e-4) << i;
    EXPECT_NEAR(found->y(), p_from_W.y(), 1e-4) << i;
  }
}

TEST(InertialZmp, IsInvalidInFreeFall) {
  const sim_board::RobotDescription robot = box_rig(1.5, {0.1, 0.06, 0.2});
  sim_board::WorldOptions options;
  options.ground.present = false;
  const auto world = sim_board::make_world(robot, options);
  InertialZmp zmp(robot, kGravity_m_per_s2 * (1.0 - 1e-9));  // so that round-off is not a load
  zmp.observe(*world);
  world->step();
  EXPECT_FALSE(zmp.observe(*world).has_value());
}

TEST(InertialZmp, IsBelowTheCentreOfMassAtRest) {
  const sim_board::RobotDescription robot = box_rig(1.5, {0.1, 0.06, 0.2});
  sim_board::WorldOptions options;
  options.X_WB.translation() = Vector3d(0.3, -0.2, 0.1);
  const auto world = sim_board::make_world(robot, options);
  run_for(*world, 1.0);
  InertialZmp zmp(robot, kGravity_m_per_s2);
  zmp.observe(*world);
  world->step();
  EXPECT_TRUE(zmp.observe(*world).value().isApprox(Vector2d(0.3, -0.2), 1e-6));
}

}  // namespace
}  // namespace koboshi::lab
