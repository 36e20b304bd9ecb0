#include <gtest/gtest.h>

#include "lab/bring_up/rungs.h"

namespace koboshi::lab {
namespace {

sim_board::ServoDescription servo_at(double supply_V) {
  sim_board::ServoDescription servo;
  servo.resistance_ohm = 2.0;
  servo.supply_V = supply_V;
  return servo;
}

TEST(TorqueLimits, PeakIsTheStallTorqueThatALowSupplyLeaves) {
  EXPECT_DOUBLE_EQ(torque_limits(servo_at(10.0), 8.0).peak, 0.8);
  EXPECT_DOUBLE_EQ(torque_limits(servo_at(10.0), 12.0).peak, 1.0);  // no servo has more than its stall torque
  EXPECT_FALSE(torque_limits(servo_at(10.0), 8.0).continuous);
}

TEST(TorqueLimits, ContinuousTorqueHeatsTheWindingToTheDerating) {
  sim_board::ServoDescription servo = servo_at(10.0);
  servo.winding = sim_board::WindingDescription{.thermal_resistance_K_per_W = 15.0,
                                                .heat_capacity_J_per_K = 8.0,
                                                .ambient_C = 25.0,
                                                .derating_C = 85.0,
                                                .copper_per_K = 0.004};
  const auto continuous = torque_limits(servo, 8.0).continuous;
  ASSERT_TRUE(continuous);
  // The losses at that current, in the hot winding, are those that 60 K above the air carry away.
  const double current_A = *continuous * 10.0 / 2.0;
  const double hot_ohm = 2.0 * (1.0 + 0.004 * 60.0);
  EXPECT_NEAR(current_A * current_A * hot_ohm, 60.0 / 15.0, 1e-12);
}

}  // namespace
}  // namespace koboshi::lab
