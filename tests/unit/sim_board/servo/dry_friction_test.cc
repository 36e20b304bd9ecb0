#include "sim_board/servo/dry_friction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/sim_board/servo/servo_bench.h"

namespace koboshi::sim_board {
namespace {

ServoDescription mx_106_m6() {
  return {.coulomb_friction_Nm = 0.01,
          .stribeck = {.friction_Nm = 0.122, .speed_rad_per_s = 1.746, .exponent = 1.143},
          .load_friction = {.motor = 0.198, .external = 0.0222},
          .stribeck_load_friction = {.motor = 0.1986, .external = 0.0871},
          .quadratic_load_friction_per_Nm = {.motor = 0.01, .external = 0.002}};
}

// Load-dependent, and quick to show it: half of it goes at 1.5 rad/s.
ServoDescription xl_320_like() {
  return {.coulomb_friction_Nm = 0.01,
          .viscous_friction_Nm_s = 0.05,
          .stribeck = {.friction_Nm = 0.02, .speed_rad_per_s = 2.0, .exponent = 1.7},
          .load_friction = {.motor = 0.15, .external = 0.15},
          .stribeck_load_friction = {.motor = 0.25, .external = 0.25}};
}

TEST(DryFriction, EqualsCoulombsLawInModelM1) {
  const DryFriction friction({.coulomb_friction_Nm = 0.03});
  EXPECT_EQ(friction.bound_Nm(2.0, -3.0, 0.5), 0.03);
  EXPECT_EQ(friction.bound_Nm(0.0, 0.0, 0.0), 0.03);
}

// Numbers of the formula in Rhoban's bam/model.py, computed apart.
TEST(DryFriction, EqualsBamInModelM4) {
  const DryFriction friction({.coulomb_friction_Nm = 0.06,
                              .stribeck = {.friction_Nm = 0.024, .speed_rad_per_s = 1.52, .exponent = 1.33},
                              .load_friction = {.motor = 0.009, .external = 0.009},
                              .stribeck_load_friction = {.motor = 0.234, .external = 0.234}});
  EXPECT_NEAR(friction.bound_Nm(2.0, -1.0, 1.0), 0.496345161, 1e-9);
}

TEST(DryFriction, EqualsBamInModelM6) {
  const DryFriction friction(mx_106_m6());
  EXPECT_NEAR(friction.bound_Nm(2.0, -3.0, 0.5), 1.118364974, 1e-9);   // driven back: the motor's square
  EXPECT_NEAR(friction.bound_Nm(3.0, -2.0, -0.5), 1.356734523, 1e-9);  // it lifts: the load's
  EXPECT_NEAR(friction.bound_Nm(2.0, 3.0, 0.5), 0.542377193, 1e-9);    // both the same way: none
  EXPECT_NEAR(friction.bound_Nm(2.0, -3.0, 0.0), 1.293100000, 1e-9);
}

TEST(DryFriction, HoldsALimpArmUntilTheLoadExceedsTheFriction) {
  // te = Kc + Kcs + (Kl + Kls) te
  const double breaks_Nm = (0.01 + 0.02) / (1.0 - 0.15 - 0.25);
  for (const double share : {0.98, 1.02}) {
    ServoBench bench(xl_320_like());
    // As slowly as the servo can feel it: each step knows the load of the one before.
    for (int ms = 0; ms < 1000; ++ms) bench.release(share * breaks_Nm * ms / 1000);
    for (int ms = 0; ms < 300; ++ms) bench.release(share * breaks_Nm);
    if (share < 1.0) {
      EXPECT_LT(std::abs(bench.joint().position_rad), 1e-6);
    } else {
      EXPECT_GT(bench.joint().position_rad, 1e-3);
    }
  }
}

TEST(DryFriction, DoesNotChatterUnderLoad) {
  for (const double step_s : {0.001, 0.0005, 0.0001}) {
    for (const double inertia_kg_m2 : {1e-5, 1e-4, 1e-2}) {
      ServoBench bench(xl_320_like(), step_s, 0.0, inertia_kg_m2);
      for (int ms = 0; ms < 3000; ++ms) bench.release(0.3);  // driven back, steadily
      const double speed_rad_per_s = bench.joint().speed_rad_per_s;
      const double bound_Nm = bench.torque().friction_Nm;
      EXPECT_GT(speed_rad_per_s, 0.5);
      for (int ms = 0; ms < 20; ++ms) {
        bench.release(0.3);
        EXPECT_NEAR(bench.joint().speed_rad_per_s, speed_rad_per_s, 1e-6) << step_s << ' ' << inertia_kg_m2;
        EXPECT_NEAR(bench.torque().friction_Nm, bound_Nm, 1e-6);
      }
      // In balance: the load against viscous and dry friction.
      EXPECT_NEAR(0.05 * speed_rad_per_s + bound_Nm, 0.3, 1e-4);
    }
  }
}

TEST(DryFriction, KeepsALoadedArmStill) {
  for (const double step_s : {0.001, 0.0001}) {
    ServoBench bench(xl_320_like(), step_s, 0.3);
    for (int ms = 0; ms < 1500; ++ms) bench.drive(0.2);
    const double held_rad = bench.joint().position_rad;
    EXPECT_GT(held_rad, 0.05);
    for (int ms = 0; ms < 500; ++ms) {
      bench.drive(0.2);
      EXPECT_NEAR(bench.joint().position_rad, held_rad, 2e-6);
    }
  }
}

// Up and down between the same targets, an arm under load stops short of both: friction gives what the motor
// lacks on the way up, and holds what it has too much on the way down.
TEST(DryFriction, CausesAHysteresisThatGrowsWithTheLoad) {
  std::vector<double> widths_rad;
  for (const double weight_Nm : {0.05, 0.2, 0.4}) {
    ServoBench bench(xl_320_like(), 0.001, weight_Nm);
    std::vector<double> rests_rad;
    for (const double from_rad : {-0.1, 0.1}) {
      for (int ms = 0; ms <= 2000; ++ms) bench.drive(from_rad * (1.0 - ms / 2000.0));
      for (int ms = 0; ms < 300; ++ms) bench.drive(0.0);
      rests_rad.push_back(bench.joint().position_rad);
    }
    widths_rad.push_back(rests_rad[1] - rests_rad[0]);
  }
  EXPECT_GT(widths_rad[0], 0.0);
  EXPECT_GT(widths_rad[1], 1.3 * widths_rad[0]);
  EXPECT_GT(widths_rad[2], 1.3 * widths_rad[1]);
}

}  // namespace
}  // namespace koboshi::sim_board
