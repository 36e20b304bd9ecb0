#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "sim_board/world/ode_world.h"
#include "tests/unit/sim_board/world/sample_robots.h"

namespace koboshi::sim {
namespace {

TEST(World, DropsABodyAsGravityDictates) {
  WorldOptions options;
  options.X_WB.translation().z() = 10.0;
  const auto world = make_ode_world(sample_box(0.7, {0.1, 0.2, 0.3}), options);
  for (int i = 0; i < 1000; ++i) world->step();
  EXPECT_NEAR(world->time_s(), 1.0, 1e-12);
  // Semi-implicit Euler falls g h t / 2 further than the parabola.
  EXPECT_NEAR(world->body(0).X_WL.translation().z(), 10.0 - 0.5 * 9.80665 * (1.0 + 0.001), 1e-6);
  EXPECT_NEAR(world->body(0).v_WCom_W.z(), -9.80665, 1e-9);
  EXPECT_TRUE(world->contacts().empty());
}

}  // namespace
}  // namespace koboshi::sim
