// The servo in the constraint solver against the same motor integrated finely: J w' = kt (V - kt w)/R - Kv w
// - Kc sgn w + tau in steps of a microsecond with the classical Runge-Kutta method, its digital loop written
// out again.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "sim_board/engine/make_world.h"
#include "sim_board/servo/servo.h"
#include "tests/support/sample_robots.h"

namespace koboshi::sim_board {
namespace {

constexpr double kLinkInertia = 1e-4;  // kg m^2
constexpr double kUnitsPerRad = (1 << 20) / (2.0 * std::numbers::pi);

// The events of the servo, by time in milliseconds since the start.
struct Experiment {
  std::function<double(int)> target_rad = [](int) { return 0.0; };
  std::function<double(int)> blow_Nm = [](int) { return 0.0; };  // on the output
  int duration_ms = 500;
  bool driven = true;
  int encoder_bits = 20;
  double coulomb_friction_Nm = 0.0275;
};

// At each millisecond.
struct Motion {
  std::vector<double> position_rad;
  std::vector<double> speed_rad_per_s;
};

JointDescription joint_of(const Experiment& experiment) {
  JointDescription joint = sample_hinge({.inertia_kg_m2 = kLinkInertia}).joints[0];
  joint.servo.coulomb_friction_Nm = experiment.coulomb_friction_Nm;
  joint.encoder.bits = experiment.encoder_bits;
  return joint;
}

Motion simulate(const Experiment& experiment, double step_s) {
  WorldOptions options;
  options.step_s = step_s;
  options.gravity_W_m_per_s2.setZero();
  options.ground.present = false;
  options.fixed_base = true;
  const auto world = make_world(sample_hinge({.inertia_kg_m2 = kLinkInertia}), options);
  Servo servo(joint_of(experiment), {.step_s = step_s});
  Motion motion;
  const auto steps_a_ms = std::lround(0.001 / step_s);
  for (int ms = 0; ms < experiment.duration_ms; ++ms) {
    servo.sense(world->joint(0));
    const auto target = static_cast<std::int32_t>(std::lround(experiment.target_rad(ms) * kUnitsPerRad));
    if (experiment.driven) {
      servo.drive(target);
    } else {
      servo.release();
    }
    for (long i = 0; i < steps_a_ms; ++i) {
      servo.draw(world->joint(0));
      world->set_servo(0, servo.torque(7.5));
      // A couple: the lever of 0.1 m turns with the arm, so the force does too.
      const double angle = world->joint(0).position_rad;
      const Eigen::Vector3d across(-std::sin(angle), 0.0, -std::cos(angle));
      world->push(1, {0.1, 0.0, 0.0}, experiment.blow_Nm(ms) / 0.1 * across);
      world->step();
    }
    motion.position_rad.push_back(world->joint(0).position_rad);
    motion.speed_rad_per_s.push_back(world->joint(0).speed_rad_per_s);
  }
  return motion;
}

// One microsecond of the motor under a constant voltage and outer torque.
class Reference {
 public:
  explicit Reference(const Experiment& experiment) : experiment_(experiment) {}

  Motion run() {
    Motion motion;
    for (int ms = 0; ms < experiment_.duration_ms; ++ms) {
      const double count_rad = 2.0 * std::numbers::pi / (1 << experiment_.encoder_bits);
      const double measured_rad = std::floor(position_ / count_rad + 0.5) * count_rad;
      const double target_rad = std::round(experiment_.target_rad(ms) * kUnitsPerRad) / kUnitsPerRad;
      const double voltage = std::clamp((target_rad - measured_rad) * 7.5 / 0.122, -7.5, 7.5);
      outer_ = experiment_.blow_Nm(ms) + (experiment_.driven ? 1.0027 * voltage / 5.477 : 0.0);
      damping_ = 0.0033 + (experiment_.driven ? 1.0027 * 1.0027 / 5.477 : 0.0);
      for (int us = 0; us < 1000; ++us) advance();
      motion.position_rad.push_back(position_);
      motion.speed_rad_per_s.push_back(speed_);
    }
    return motion;
  }

 private:
  double acceleration(double speed, double direction) const {
    return (outer_ - damping_ * speed - direction * experiment_.coulomb_friction_Nm) /
           (kLinkInertia + 0.00116);
  }

  void advance() {
    if (speed_ == 0.0 && std::abs(outer_) <= experiment_.coulomb_friction_Nm) return;
    const double direction = std::copysign(1.0, speed_ == 0.0 ? outer_ : speed_);
    const double h = 1e-6;
    const double k1 = acceleration(speed_, direction);
    const double k2 = acceleration(speed_ + 0.5 * h * k1, direction);
    const double k3 = acceleration(speed_ + 0.5 * h * k2, direction);
    const double k4 = acceleration(speed_ + h * k3, direction);
    position_ += h * (speed_ + h * (k1 + k2 + k3) / 6.0);
    speed_ += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
    if (direction * speed_ < 0.0) speed_ = 0.0;  // it stands; friction decides anew
  }

  Experiment experiment_;
  double position_ = 0.0;
  double speed_ = 0.0;
  double outer_ = 0.0;
  double damping_ = 0.0;
};

double largest(const std::vector<double>& values) {
  double result = 0.0;
  for (const double value : values) result = std::max(result, std::abs(value));
  return result;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double result = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) result = std::max(result, std::abs(a[i] - b[i]));
  return result;
}

// Largest position error over the whole motion, relative to the reference's range.
double position_error(const Experiment& experiment, double step_s) {
  const Motion reference = Reference(experiment).run();
  return largest_difference(simulate(experiment, step_s).position_rad, reference.position_rad) /
         largest(reference.position_rad);
}

// Within 1 % at 1 ms, and of first order: halving the step halves the error.
void expect_first_order(const Experiment& experiment) {
  const double at_1000_us = position_error(experiment, 0.001);
  const double at_500_us = position_error(experiment, 0.0005);
  const double at_250_us = position_error(experiment, 0.00025);
  EXPECT_LT(at_1000_us, 0.01);
  EXPECT_GT(at_1000_us, 1e-5);  // nothing of first order is that good: the reference would be the simulation
  EXPECT_NEAR(at_1000_us / at_500_us, 2.0, 0.3);
  EXPECT_NEAR(at_500_us / at_250_us, 2.0, 0.3);
}

Experiment step_of(double amplitude_rad) {
  Experiment experiment;
  experiment.target_rad = [amplitude_rad](int) { return amplitude_rad; };
  return experiment;
}

TEST(ServoAgainstReference, FollowsASmallStep) { expect_first_order(step_of(0.1)); }

TEST(ServoAgainstReference, FollowsALargeStep) { expect_first_order(step_of(1.0)); }

TEST(ServoAgainstReference, FollowsAStepWithAQuantisedEncoder) {
  for (const double amplitude_rad : {0.1, 0.5, 1.5}) {
    Experiment experiment = step_of(amplitude_rad);
    experiment.encoder_bits = 12;
    EXPECT_LT(position_error(experiment, 0.001), 0.01) << amplitude_rad;
  }
}

TEST(ServoAgainstReference, FollowsASine) {
  for (const double frequency_Hz : {1.0, 4.0}) {
    Experiment experiment;
    experiment.duration_ms = 1000;
    experiment.target_rad = [frequency_Hz](int ms) {
      return 0.3 * std::sin(2.0 * std::numbers::pi * frequency_Hz * 0.001 * ms);
    };
    expect_first_order(experiment);
    experiment.encoder_bits = 12;
    EXPECT_LT(position_error(experiment, 0.001), 0.01) << frequency_Hz;
  }
}

TEST(ServoAgainstReference, ReachesItsNoLoadSpeed) {
  Experiment experiment = step_of(100.0);
  const double expected = (1.0027 * 7.5 / 5.477 - 0.0275) / (1.0027 * 1.0027 / 5.477 + 0.0033);
  EXPECT_NEAR(simulate(experiment, 0.001).speed_rad_per_s.back(), expected, 1e-6);
}

TEST(ServoAgainstReference, StallsAgainstAnExternalTorque) {
  Experiment experiment = step_of(1.0);
  // As much as the motor has, less than it has with friction: it does not move.
  experiment.blow_Nm = [](int) { return -1.0027 * 7.5 / 5.477; };
  EXPECT_LT(largest(simulate(experiment, 0.001).position_rad), 1e-6);
  EXPECT_EQ(largest(Reference(experiment).run().position_rad), 0.0);
  // Driven back by a torque beyond stall and friction.
  experiment.blow_Nm = [](int) { return -1.6; };
  expect_first_order(experiment);
}

TEST(ServoAgainstReference, RespondsToAnImpactOnItsOutput) {
  Experiment blow;
  blow.duration_ms = 200;
  blow.blow_Nm = [](int ms) { return ms == 0 ? 6.0 : 0.0; };
  const double reference = Reference(blow).run().speed_rad_per_s[0];
  const double at_1000_us = 1.0 - simulate(blow, 0.001).speed_rad_per_s[0] / reference;
  const double at_500_us = 1.0 - simulate(blow, 0.0005).speed_rad_per_s[0] / reference;
  const double at_250_us = 1.0 - simulate(blow, 0.00025).speed_rad_per_s[0] / reference;
  EXPECT_LT(std::abs(at_1000_us), 0.07);
  EXPECT_GT(at_1000_us, 0.04);  // the implicit back EMF brakes too much
  EXPECT_NEAR(at_1000_us / at_500_us, 2.0, 0.3);
  EXPECT_NEAR(at_500_us / at_250_us, 2.0, 0.3);
}

TEST(ServoAgainstReference, RespondsToAnImpactWithTheInertiaOfLinkAndRotor) {
  Experiment blow;
  blow.duration_ms = 1;
  blow.driven = false;
  blow.coulomb_friction_Nm = 0.0;
  blow.blow_Nm = [](int) { return 6.0; };
  // 4.76 rad/s, less 0.13 % of viscous friction.
  EXPECT_NEAR(simulate(blow, 0.001).speed_rad_per_s[0], 6.0 * 0.001 / (kLinkInertia + 0.00116), 0.015);
}

TEST(ServoAgainstReference, StartsAndStopsByFriction) {
  Experiment experiment;
  experiment.driven = false;
  experiment.duration_ms = 600;
  // Too little, enough, then nothing: it rests, slides, and comes to rest.
  experiment.blow_Nm = [](int ms) { return ms < 100 ? 0.027 : ms < 200 ? 0.06 : 0.0; };
  expect_first_order(experiment);
  const Motion motion = simulate(experiment, 0.001);
  EXPECT_LT(std::abs(motion.position_rad[99]), 1e-8);
  EXPECT_LT(std::abs(motion.speed_rad_per_s.back()), 1e-9);
}

TEST(ServoAgainstReference, StandsStillWithinItsFriction) {
  Experiment experiment = step_of(0.0002);  // an error whose voltage makes less torque than friction
  experiment.duration_ms = 1000;
  EXPECT_LT(largest(simulate(experiment, 0.001).position_rad), 1e-6);
}

}  // namespace
}  // namespace koboshi::sim_board
