#include "sim_board/servo/backlash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/sim_board/servo/servo_bench.h"

namespace koboshi::sim_board {
namespace {

constexpr double kGap_rad = 0.02;
constexpr double kRotor_kg_m2 = 0.001;

ServoDescription with_backlash() { return {.rotor_inertia_kg_m2 = kRotor_kg_m2, .backlash_rad = kGap_rad}; }

TEST(Backlash, LetsTheRotorRunAcrossTheGapAlone) {
  const double step_s = 1e-5;
  Backlash backlash(with_backlash(), step_s);
  const ServoTorque push{.drive_Nm = 0.5, .rotor_inertia_kg_m2 = kRotor_kg_m2, .friction_Nm = 0.1};
  int steps = 0;
  for (; !backlash.engaged(); ++steps) {
    backlash.observe({});
    ServoTorque torque = push;
    backlash.apply(torque);
    if (backlash.engaged()) break;
    EXPECT_EQ(torque.drive_Nm, 0.0);
    EXPECT_EQ(torque.friction_Nm, 0.0);
    EXPECT_EQ(torque.damping_Nm_s, 0.0);
    EXPECT_EQ(torque.rotor_inertia_kg_m2, 0.0);
    EXPECT_EQ(backlash.external_Nm(), 0.0);
  }
  // Half the gap, from rest with (0.5 - 0.1) / J.
  EXPECT_NEAR(steps * step_s, std::sqrt(kGap_rad * kRotor_kg_m2 / 0.4), 0.01 * steps * step_s);
  EXPECT_EQ(backlash.edge(), 1);
}

TEST(Backlash, BeginsInTheMiddleWhereverTheShaftIs) {
  Backlash backlash(with_backlash(), 0.001);
  const JointState shaft{.position_rad = 1.5};
  for (int i = 0; i < 3; ++i) {
    backlash.observe(shaft);
    EXPECT_EQ(backlash.lead_rad(), 0.0);
    EXPECT_FALSE(backlash.engaged());
    ServoTorque torque{.rotor_inertia_kg_m2 = kRotor_kg_m2};
    backlash.apply(torque);
  }
}

TEST(Backlash, StopsARotorAtTheEdgeHoweverSlowItIs) {
  Backlash backlash(with_backlash(), 0.001);
  int steps = 0;
  for (; steps < 5'000 && !backlash.engaged(); ++steps) {
    backlash.observe({});
    ServoTorque torque{.drive_Nm = -0.0005, .rotor_inertia_kg_m2 = kRotor_kg_m2};
    torque.damping_Nm_s = 0.005;
    backlash.apply(torque);
  }
  EXPECT_EQ(backlash.edge(), -1);
  EXPECT_LT(std::abs(backlash.rotor_speed_rad_per_s()), 0.11);
  EXPECT_NEAR(backlash.lead_rad(), -0.5 * kGap_rad, 1e-12);
  EXPECT_NEAR(steps * 0.001, 0.5 * kGap_rad / 0.1 + 0.2, 0.11);
}

TEST(Backlash, HoldsTheRotorByItsOwnFriction) {
  Backlash backlash(with_backlash(), 0.001);
  for (int i = 0; i < 100; ++i) {
    backlash.observe({});
    ServoTorque torque{.drive_Nm = 0.099, .rotor_inertia_kg_m2 = kRotor_kg_m2, .friction_Nm = 0.1};
    backlash.apply(torque);
  }
  EXPECT_EQ(backlash.rotor_speed_rad_per_s(), 0.0);
  EXPECT_EQ(backlash.lead_rad(), 0.0);
}

TEST(Backlash, GivesTheOutputTheRotorsMomentumAtTheEdge) {
  const double step_s = 0.001;
  Backlash backlash(with_backlash(), step_s);
  ServoTorque torque;
  for (int i = 0; i < 1000 && !backlash.engaged(); ++i) {
    backlash.observe({});
    torque = {.drive_Nm = 0.5, .rotor_inertia_kg_m2 = kRotor_kg_m2};
    backlash.apply(torque);
  }
  const double arriving_rad_per_s = backlash.rotor_speed_rad_per_s();
  EXPECT_GT(arriving_rad_per_s, 1.0);
  // The solver adds J/h of the output's speed, zero here: together J/h of the rotor's.
  EXPECT_NEAR(torque.drive_Nm, 0.5 + kRotor_kg_m2 / step_s * arriving_rad_per_s, 1e-9);
  // Only once.
  backlash.observe({.speed_rad_per_s = 1.0, .servo_Nm = 0.3});
  torque = {.drive_Nm = 0.5, .rotor_inertia_kg_m2 = kRotor_kg_m2};
  backlash.apply(torque);
  EXPECT_EQ(torque.drive_Nm, 0.5);
}

TEST(Backlash, SeparatesWhereTheServoWouldPull) {
  Backlash backlash(with_backlash(), 0.001);
  ServoTorque torque;
  for (int i = 0; i < 1000 && !backlash.engaged(); ++i) {
    backlash.observe({});
    torque = {.drive_Nm = 0.5, .rotor_inertia_kg_m2 = kRotor_kg_m2};
    backlash.apply(torque);
  }
  backlash.observe({.servo_Nm = 0.2});
  EXPECT_EQ(backlash.edge(), 1);
  EXPECT_EQ(backlash.external_Nm(), -0.2);
  backlash.observe({.servo_Nm = -1e-6});
  EXPECT_EQ(backlash.edge(), 0);
}

TEST(Backlash, GivesTheLimpShaftItsPlay) {
  ServoDescription servo = with_backlash();
  servo.coulomb_friction_Nm = 0.1;
  ServoBench bench(servo);
  // Less than the gears' friction: what moves, moves within the gap.
  for (int ms = 0; ms < 300; ++ms) bench.release(0.01);
  const double one_end_rad = bench.joint().position_rad;
  for (int ms = 0; ms < 300; ++ms) bench.release(-0.01);
  // The shaft arrives with some speed, and takes the rotor along a little.
  EXPECT_NEAR(one_end_rad - bench.joint().position_rad, kGap_rad, 0.15 * kGap_rad);
}

TEST(Backlash, DoesNotChatterUnderLoad) {
  for (const double step_s : {0.001, 0.0005, 0.0001}) {
    ServoBench bench(with_backlash(), step_s, 0.2);
    for (int ms = 0; ms < 1000; ++ms) bench.drive(0.0);
    const int changes = bench.edge_changes();
    const double held_rad = bench.joint().position_rad;
    EXPECT_EQ(bench.servo().backlash().edge(), 1);  // it pushes up
    for (int ms = 0; ms < 1000; ++ms) bench.drive(0.0);
    EXPECT_EQ(bench.edge_changes(), changes) << step_s;
    EXPECT_NEAR(bench.joint().position_rad, held_rad, 1e-6) << step_s;
  }
}

// A step up with a weight on the arm: the gap is crossed at the start and after the overshoot.
std::vector<double> step_up(double step_s) {
  ServoBench bench(with_backlash(), step_s, 0.15);
  std::vector<double> positions_rad;
  for (int ms = 0; ms < 600; ++ms) {
    bench.drive(ms < 300 ? 0.0 : 0.3);
    positions_rad.push_back(bench.joint().position_rad);
  }
  return positions_rad;
}

TEST(Backlash, ConvergesWithTheStep) {
  const std::vector<double> fine = step_up(0.00005);
  std::vector<double> errors_rad;
  for (const double step_s : {0.001, 0.0005, 0.0001}) {
    const std::vector<double> coarse = step_up(step_s);
    double error_rad = 0.0;
    for (std::size_t i = 0; i < fine.size(); ++i)
      error_rad = std::max(error_rad, std::abs(coarse[i] - fine[i]));
    errors_rad.push_back(error_rad);
  }
  EXPECT_LT(errors_rad[0], 0.003);  // 1 % of the step, as without backlash
  EXPECT_GT(errors_rad[0], 1e-4);   // nothing of first order is that good
  EXPECT_LT(errors_rad[1], 0.6 * errors_rad[0]);
  EXPECT_LT(errors_rad[2], 0.3 * errors_rad[1]);
}

TEST(Backlash, WithoutAGapChangesNothing) {
  Backlash backlash(ServoDescription{}, 0.001);
  backlash.observe({.position_rad = 1.0, .speed_rad_per_s = 2.0, .servo_Nm = 0.3});
  ServoTorque torque{.drive_Nm = 0.5, .damping_Nm_s = 0.1, .rotor_inertia_kg_m2 = 0.001, .friction_Nm = 0.02};
  backlash.apply(torque);
  EXPECT_TRUE(backlash.engaged());
  EXPECT_EQ(torque.drive_Nm, 0.5);
  EXPECT_EQ(torque.friction_Nm, 0.02);
  EXPECT_EQ(backlash.rotor_speed_rad_per_s(), 2.0);
  EXPECT_EQ(backlash.external_Nm(), -0.3);
}

}  // namespace
}  // namespace koboshi::sim_board
