#include <gtest/gtest.h>

#include "sim_board/engine/make_world.h"
#include "tests/support/allocations.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

using test::allocations;

class Allocations : public EachEngine {};

// ODE's own arenas, which come from malloc, are not counted.
TEST_P(Allocations, DoNotOccurInAStep) {
  WorldOptions options = Allocations::options();
  options.X_WB.translation().z() = kSampleHumanoidHeight_m + 0.02;
  const auto world = make_world(sample_humanoid(), options);
  const long before = allocations();
  std::size_t most_contacts = 0;
  for (int i = 0; i < 500; ++i) {  // it drops, folds up and lies
    for (int j = 0; j < 20; ++j) world->set_servo(j, {.friction_Nm = 0.002});
    world->push(0, Eigen::Vector3d::Zero(), {0.5, 0.0, 0.0});
    world->step();
    most_contacts = std::max(most_contacts, world->contacts().size());
  }
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(most_contacts, 8U);
}

INSTANTIATE_TEST_SUITE_P(Engines, Allocations,
                         testing::Values(Stepper::kWorld, Stepper::kLumped, Stepper::kMujoco), engine_name);

TEST(World, StepsOnEveryKindOfGroundWithoutAllocation) {
  WorldOptions options;
  options.X_WB.translation().z() = kSampleHumanoidHeight_m + 0.05;
  options.ground.patches.emplace_back().surface.friction = 0.1;
  options.ground.boxes = stair_boxes({.X_WR = Eigen::Isometry3d(Eigen::Translation3d(0.05, 0.0, 0.0)),
                                      .count = 2,
                                      .rise_m = 0.015,
                                      .run_m = 0.05,
                                      .width_m = 1.0});
  HeightField& field = options.ground.height_fields.emplace_back();
  field.columns = field.rows = 101;
  for (int i = 0; i < 101 * 101; ++i) field.heights_m.push_back(i % 3 == 0 ? 0.02 : 0.015);
  const auto world = make_world(sample_humanoid(), options);
  const long before = allocations();
  std::size_t most_contacts = 0;
  for (int i = 0; i < 300; ++i) {
    world->step();
    most_contacts = std::max(most_contacts, world->contacts().size());
  }
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(most_contacts, 16U);
}

}  // namespace
}  // namespace koboshi::sim_board
