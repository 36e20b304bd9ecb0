#include "lab/validate/servo_trial.h"

#include <gtest/gtest.h>

#include <cmath>

namespace koboshi::lab {
namespace {

TEST(ServoReference, RunsUpToItsSteadySpeedExponentially) {
  ServoTrial trial;
  trial.target_rad = [](double) { return 1000.0; };  // the whole supply all along
  trial.load_Nm = -0.3;
  trial.duration_s = 0.1;
  const ServoMotion motion = reference(trial);
  const double steady = steady_speed_rad_per_s(trial.servo, trial.load_Nm);
  const double kt = trial.servo.torque_constant_Nm_per_A;
  const double decay = (kt * kt / trial.servo.resistance_ohm + trial.servo.viscous_friction_Nm_s) /
                       (trial.servo.rotor_inertia_kg_m2 + trial.link_inertia_kg_m2);
  for (std::size_t i = 0; i < motion.time_s.size(); i += 7) {
    const double t = motion.time_s[i];
    EXPECT_NEAR(motion.speed_rad_per_s[i], steady * -std::expm1(-decay * t), 1e-9);
    EXPECT_NEAR(motion.position_rad[i], steady * (t + std::expm1(-decay * t) / decay), 1e-9);
  }
}

TEST(ServoReference, StandsWithinItsFriction) {
  ServoTrial trial;
  trial.load_Nm = 0.9 * trial.servo.coulomb_friction_Nm;
  EXPECT_EQ(reference(trial).position_rad.back(), 0.0);
  trial.load_Nm = 1.1 * trial.servo.coulomb_friction_Nm;
  EXPECT_GT(reference(trial).position_rad.front(), 0.0);
}

TEST(ServoReference, StopsByFrictionAndStays) {
  ServoTrial trial;
  trial.target_rad = [](double) { return 0.5; };
  const ServoMotion motion = reference(trial);
  EXPECT_EQ(motion.speed_rad_per_s.back(), 0.0);
  // Where the voltage of what is left of the error makes less torque than friction.
  const double torque_Nm = trial.servo.torque_constant_Nm_per_A / trial.servo.resistance_ohm *
                           trial.servo.supply_V / trial.servo.full_voltage_error_rad *
                           std::abs(0.5 - motion.position_rad.back());
  EXPECT_LT(torque_Nm, trial.servo.coulomb_friction_Nm);
}

TEST(ServoSimulation, LagsByLessThanAStep) {
  ServoTrial trial;
  trial.target_rad = [](double) { return 0.5; };
  const double exact_rad = reference(trial).position_rad[20];
  const double error_rad = simulated(trial, {}).position_rad[20] - exact_rad;
  EXPECT_LT(std::abs(error_rad), 0.001 * 7.5);
  EXPECT_GT(std::abs(error_rad), 1e-6);  // or the reference would be the simulation
}

}  // namespace
}  // namespace koboshi::lab
