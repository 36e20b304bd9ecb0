// Supply, heat, current limit, command timing, encoder noise: each effect alone against its formula.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/sim_board/servo/servo_bench.h"

namespace koboshi::sim_board {
namespace {

constexpr std::int32_t kFullError = 1 << 18;

// A servo that is held, at whole duty.
struct StalledServo {
  explicit StalledServo(const JointDescription& joint = {}) : servo(joint) {}

  Servo servo;

  SupplyLoad draw() {
    servo.sense({});
    servo.drive(kFullError);
    return servo.draw({});
  }
};

TEST(Battery, SagsForAllMotorsConnectedToIt) {
  const Battery battery({.open_circuit_V = 8.0, .internal_resistance_ohm = 0.5});
  StalledServo a, b;
  SupplyLoad load = a.draw();
  load += b.draw();
  const double supply_V = battery.voltage_V(load);
  // Two motors of 5.477 ohm in parallel, behind 0.5 ohm.
  EXPECT_NEAR(supply_V, 8.0 * (5.477 / 2) / (5.477 / 2 + 0.5), 1e-9);
  EXPECT_NEAR(a.servo.torque(supply_V).drive_Nm, 1.0027 * supply_V / 5.477, 1e-9);
}

TEST(Battery, StaysStableUnderMoreMotorsThanItCanSupply) {
  // Conductance times resistance is 3.7: the current of the last step would make it swing up.
  const Battery battery({.open_circuit_V = 8.0, .internal_resistance_ohm = 1.0});
  std::vector<StalledServo> servos(20);
  for (int step = 0; step < 5; ++step) {
    SupplyLoad load;
    for (StalledServo& stalled : servos) load += stalled.draw();
    const double supply_V = battery.voltage_V(load);
    EXPECT_NEAR(supply_V, 8.0 / (1.0 + 20.0 / 5.477), 1e-9);
    for (StalledServo& stalled : servos) stalled.servo.torque(supply_V);
  }
}

TEST(Battery, LosesNoPowerInTheBridge) {
  JointDescription joint;
  Servo servo(joint);
  const JointState turning{.speed_rad_per_s = 2.0};
  servo.sense(turning);
  servo.drive(1 << 13);
  const SupplyLoad load = servo.draw(turning);
  servo.torque(7.0);
  servo.sense(turning);
  const double motor_V = servo.current_A() * 5.477 + 1.0027 * 2.0;
  EXPECT_NEAR(7.0 * (load.conductance_S * 7.0 - load.generated_A), motor_V * servo.current_A(), 1e-9);
}

TEST(Battery, IsChargedByABrakingMotor) {
  const Battery battery({.open_circuit_V = 8.0, .internal_resistance_ohm = 0.5});
  JointDescription joint;
  Servo servo(joint);
  const JointState fast{.speed_rad_per_s = 7.0};
  servo.sense(fast);
  servo.drive(1 << 13);
  EXPECT_GT(battery.voltage_V(servo.draw(fast)), 8.0);
}

TEST(CurrentLimit, BoundsTheTorqueOfAStalledMotorInBothDirections) {
  JointDescription joint;
  joint.servo.current_limit_A = 0.4;
  Servo servo(joint);
  for (const std::int32_t target : {kFullError, -kFullError}) {
    servo.sense({});
    servo.drive(target);
    servo.draw({});
    EXPECT_NEAR(servo.torque(7.5).drive_Nm, std::copysign(1.0027 * 0.4, target), 1e-9);
  }
}

TEST(CurrentLimit, BoundsTheBrakingOfATurningMotor) {
  JointDescription joint;
  joint.servo.current_limit_A = 0.4;
  Servo servo(joint);
  const JointState turning{.speed_rad_per_s = 5.0};
  servo.sense(turning);
  servo.drive(-kFullError);
  servo.draw(turning);
  servo.torque(7.5);
  servo.sense(turning);
  EXPECT_NEAR(servo.current_A(), -0.4, 1e-9);
}

// The error is of first order in the step, in which the back EMF grows but the voltage does not.
TEST(CurrentLimit, AcceleratesInProportionToTorque) {
  const double expected = 1.0027 * 0.2 / (0.00116 + 1e-4) * 0.02;
  std::vector<double> errors;
  for (const double step_s : {0.001, 0.0005, 0.0001}) {
    ServoBench bench({.coulomb_friction_Nm = 0.0, .viscous_friction_Nm_s = 0.0, .current_limit_A = 0.2},
                     step_s);
    for (int ms = 0; ms < 20; ++ms) bench.drive(3.0);
    errors.push_back(1.0 - bench.joint().speed_rad_per_s / expected);
  }
  EXPECT_NEAR(errors[0], 0.13, 0.01);  // h kt^2 / (R J) = 0.146
  EXPECT_NEAR(errors[0] / errors[1], 2.0, 0.2);
  EXPECT_NEAR(errors[1] / errors[2], 5.0, 0.5);
}

WindingDescription small_winding() {
  return {.thermal_resistance_K_per_W = 8.0,
          .heat_capacity_J_per_K = 5.0,
          .ambient_C = 25.0,
          .derating_C = 70.0,
          .shutdown_C = 90.0,
          .derated_share = 0.4,
          .copper_per_K = 0.0};
}

TEST(Winding, WarmsWithItsTimeConstant) {
  Winding winding({.resistance_ohm = 5.0, .winding = small_winding()}, 0.001);
  for (int ms = 0; ms < 40'000; ++ms) winding.heat(0.8);  // tau = 8 * 5 s
  EXPECT_NEAR(winding.temperature_C(), 25.0 + 8.0 * 0.64 * 5.0 * (1.0 - std::exp(-1.0)), 1e-6);
  for (int ms = 0; ms < 40'000; ++ms) winding.heat(0.0);
  EXPECT_NEAR(winding.temperature_C(), 25.0 + 8.0 * 3.2 * (1.0 - std::exp(-1.0)) * std::exp(-1.0), 1e-6);
}

TEST(Winding, RaisesItsResistanceLikeCopper) {
  WindingDescription description = small_winding();
  description.copper_per_K = 0.00393;
  Winding winding({.resistance_ohm = 5.0, .winding = description}, 0.001);
  EXPECT_EQ(winding.resistance_ohm(), 5.0);
  for (int ms = 0; ms < 400'000; ++ms) winding.heat(0.8);
  // T - Ta = Rth i^2 R0 (1 + alpha (T - Ta))
  const double rise_K = 8.0 * 3.2 / (1.0 - 0.00393 * 8.0 * 3.2);
  EXPECT_NEAR(winding.temperature_C(), 25.0 + rise_K, 1e-2);
  EXPECT_NEAR(winding.resistance_ohm(), 5.0 * (1.0 + 0.00393 * rise_K), 1e-3);
}

TEST(Winding, DeratesTheVoltageAndIsTooHotUntilItHasCooled) {
  Winding winding({.resistance_ohm = 5.0, .winding = small_winding()}, 0.001);
  while (winding.temperature_C() < 70.0) winding.heat(2.0);
  EXPECT_NEAR(winding.voltage_share(), 1.0, 1e-3);
  while (winding.temperature_C() < 80.0) winding.heat(2.0);
  EXPECT_NEAR(winding.voltage_share(), 0.7, 1e-3);
  EXPECT_FALSE(winding.too_hot());
  while (winding.temperature_C() < 90.0) winding.heat(2.0);
  EXPECT_NEAR(winding.voltage_share(), 0.4, 1e-3);
  EXPECT_TRUE(winding.too_hot());
  while (winding.temperature_C() > 70.1) winding.heat(0.0);
  EXPECT_TRUE(winding.too_hot());
  while (winding.temperature_C() > 69.9) winding.heat(0.0);
  EXPECT_FALSE(winding.too_hot());
}

TEST(Winding, StaysColdWithoutDescription) {
  Winding winding({.resistance_ohm = 5.0}, 0.001);
  for (int ms = 0; ms < 10'000; ++ms) winding.heat(100.0);
  EXPECT_EQ(winding.temperature_C(), 25.0);
  EXPECT_EQ(winding.resistance_ohm(), 5.0);
  EXPECT_EQ(winding.voltage_share(), 1.0);
}

TEST(Winding, WarmsByTheCurrentOfAStalledServo) {
  ServoDescription servo;
  servo.winding = small_winding();
  ServoBench bench(servo);
  for (int ms = 0; ms < 1000; ++ms) bench.drive(1.0, -1.373);  // held by the torque that it makes
  const double loss_W = 7.5 * 7.5 / 5.477;
  EXPECT_NEAR(bench.servo().winding().temperature_C(), 25.0 + 8.0 * loss_W * (1.0 - std::exp(-1.0 / 40.0)),
              0.02);
}

TEST(CommandPeriod, HoldsATargetBetween) {
  CommandPeriod period(3);
  std::vector<std::int32_t> held;
  for (std::int32_t i = 1; i <= 7; ++i) held.push_back(period.sample(i));
  EXPECT_EQ(held, (std::vector<std::int32_t>{1, 1, 1, 4, 4, 4, 7}));
  period.restart();
  EXPECT_EQ(period.sample(9), 9);
}

TEST(DelayLine, ReturnsTheInputOfSomeCallsAgo) {
  DelayLine line(2);
  std::vector<std::int32_t> out;
  for (std::int32_t i = 1; i <= 5; ++i) out.push_back(line.shift(i));
  EXPECT_EQ(out, (std::vector<std::int32_t>{1, 1, 1, 2, 3}));
  line.restart();
  EXPECT_EQ(line.shift(8), 8);
  EXPECT_EQ(DelayLine(0).shift(5), 5);
}

TEST(DeadBand, IsZeroForSmallErrors) {
  const DeadBand band(10.5 * kRadPerPositionUnit);
  EXPECT_EQ(band.target(110, 100), 100);
  EXPECT_EQ(band.target(90, 100), 100);
  EXPECT_EQ(band.target(111, 100), 111);
  EXPECT_EQ(DeadBand(0.0).target(101, 100), 101);
}

TEST(Servo, DelaysTargetsAndPositions) {
  JointDescription joint;
  joint.servo.command = {.period_ms = 4, .write_delay_ms = 3, .read_delay_ms = 2};
  Servo servo(joint);
  std::vector<double> torques_Nm;
  std::vector<std::int32_t> reported;
  for (int ms = 0; ms < 10; ++ms) {
    const JointState state{.position_rad = 0.001 * ms};
    servo.sense(state);
    reported.push_back(servo.reported_units());
    servo.drive(ms == 0 ? servo.position_units() : kFullError);
    servo.draw(state);
    torques_Nm.push_back(servo.torque(7.5).drive_Nm);
  }
  for (int ms = 0; ms < 7; ++ms) EXPECT_LT(torques_Nm[static_cast<std::size_t>(ms)], 0.1) << ms;
  for (int ms = 7; ms < 10; ++ms) EXPECT_GT(torques_Nm[static_cast<std::size_t>(ms)], 1.3) << ms;
  EXPECT_EQ(reported[1], reported[0]);
  Encoder encoder(joint.encoder);
  EXPECT_EQ(reported[9], encoder.position_units(encoder.read_counts(0.007)));
}

TEST(Encoder, AddsNoiseOfItsSize) {
  constexpr int kSamples = 20'000;
  Encoder encoder({.bits = 12, .noise_counts = 2.0}, 7, 1.0, "knee.encoder");
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double counts = encoder.read_counts(0.0);
    sum += counts;
    squares += counts * counts;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, 4.0 * 2.0 / std::sqrt(kSamples));
  EXPECT_NEAR(std::sqrt(squares / kSamples), std::sqrt(4.0 + 1.0 / 12.0), 0.05);  // and rounding
}

TEST(Encoder, DrawsTheSameNoiseForTheSameSeedAndName) {
  const EncoderDescription description{.bits = 12, .noise_counts = 2.0};
  Encoder one(description, 7, 1.0, "knee.encoder");
  Encoder same(description, 7, 1.0, "knee.encoder");
  Encoder other(description, 8, 1.0, "knee.encoder");
  Encoder quiet(description, 7, 0.0, "knee.encoder");
  int differences = 0;
  for (int i = 0; i < 100; ++i) {
    const std::int32_t counts = one.read_counts(0.5);
    EXPECT_EQ(same.read_counts(0.5), counts);
    EXPECT_EQ(quiet.read_counts(0.5), 326);
    differences += other.read_counts(0.5) != counts;
  }
  EXPECT_GT(differences, 50);
}

}  // namespace
}  // namespace koboshi::sim_board
