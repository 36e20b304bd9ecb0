#include "firmware/estimation/attitude.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "firmware/fixed/host/convert.h"
#include "tests/unit/firmware/robot/reference.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

using fixed::from_double;
using fixed::to_double;
using test::kGravity;
using test::kRadPerDegree;
using test::Point;

constexpr double kCycle_s = 0.01;
constexpr auto kMoving = AttitudeEstimator::Condition::kMoving;
constexpr auto kResting = AttitudeEstimator::Condition::kResting;

template <typename Q>
robot::Vector<Q> fixed_vector(const Point& v) {
  return {from_double<Q>(v.x), from_double<Q>(v.y), from_double<Q>(v.z)};
}

Point up_of(double roll_rad, double pitch_rad) {
  return {-std::sin(pitch_rad), std::sin(roll_rad) * std::cos(pitch_rad),
          std::cos(roll_rad) * std::cos(pitch_rad)};
}

// Reference trunk in double: integrates the up vector in the trunk's axes from its own rates, in steps of 0.1
// ms.
class Trunk {
 public:
  explicit Trunk(const Point& up) : up_(up) {}
  // Advances and returns the integral of the rates, which equals the sum of the gyro samples.
  Point turn(const std::function<Point(double)>& w_rad_per_s, double from_s) {
    constexpr int kSteps = 100;
    Point sum;
    for (int i = 0; i < kSteps; ++i) {
      const Point w = w_rad_per_s(from_s + (i + 0.5) * kCycle_s / kSteps);
      const Point step = (kCycle_s / kSteps) * w;
      if (norm(step) > 0) up_ = test::turned(up_, (1.0 / norm(step)) * step, -norm(step));
      sum = sum + step;
    }
    return sum;
  }
  const Point& up() const { return up_; }

 private:
  Point up_;
};

double error_deg(const AttitudeEstimator& attitude, const Point& up) {
  const Point seen = test::to_point(attitude.up_B());
  return std::atan2(norm(cross(seen, up)), dot(seen, up)) / kRadPerDegree;
}

TEST(AttitudeEstimator, IsUprightBeforeTheFirstAccelerometerSample) {
  AttitudeEstimator attitude;
  attitude.update({}, fixed_vector<fixed::Acceleration>({0, 0, 3.0}), kResting);
  EXPECT_EQ(attitude.up_B(), robot::kAxisZ);
}

TEST(AttitudeEstimator, AdoptsTheFirstGravityVectorWithCorrectSigns) {
  for (double roll_deg = -170; roll_deg <= 170; roll_deg += 20) {
    for (double pitch_deg = -85; pitch_deg <= 85; pitch_deg += 17) {
      AttitudeEstimator attitude;
      const Point up = up_of(roll_deg * kRadPerDegree, pitch_deg * kRadPerDegree);
      attitude.update({}, fixed_vector<fixed::Acceleration>(1.1 * kGravity * up), kResting);
      EXPECT_NEAR(to_double(attitude.roll()) / kRadPerDegree, roll_deg, 1e-4);
      EXPECT_NEAR(to_double(attitude.pitch()) / kRadPerDegree, pitch_deg, 1e-4);
      EXPECT_NEAR(norm(test::to_point(attitude.up_B())), 1.0, 1e-8);
    }
  }
}

// Gyro only, without accelerometer: a forward roll over the head and through the back, beyond any real fall.
TEST(AttitudeEstimator, IntegratesAnyRotationWithoutAnAccelerometer) {
  AttitudeEstimator attitude;
  attitude.update({}, fixed_vector<fixed::Acceleration>({0, 0, kGravity}), kResting);
  Trunk trunk({0, 0, 1});
  const auto rates = [](double t) {
    return Point{3.0 * std::sin(2.0 * t), 4.0 * std::cos(1.3 * t), 2.0 * std::sin(3.1 * t + 1.0)};
  };
  double worst_deg = 0.0;
  for (int cycle = 0; cycle < 500; ++cycle) {
    const Point turn = trunk.turn(rates, cycle * kCycle_s);
    attitude.update(fixed_vector<fixed::Ratio>(turn), {}, kMoving);
    worst_deg = std::max(worst_deg, error_deg(attitude, trunk.up()));
  }
  EXPECT_LT(worst_deg, 0.5);
}

TEST(AttitudeEstimator, PitchesForwardWithThePositiveRateAboutY) {
  AttitudeEstimator attitude;
  attitude.update({}, fixed_vector<fixed::Acceleration>({0, 0, kGravity}), kResting);
  for (int cycle = 0; cycle < 100; ++cycle) {
    attitude.update(fixed_vector<fixed::Ratio>({0, 0.5 * kCycle_s, 0}), {}, kMoving);
  }
  EXPECT_NEAR(to_double(attitude.pitch()), 0.5, 1e-4);
  for (int cycle = 0; cycle < 100; ++cycle) {
    attitude.update(fixed_vector<fixed::Ratio>({0, -0.5 * kCycle_s, 0}), {}, kMoving);
  }
  for (int cycle = 0; cycle < 100; ++cycle) {
    attitude.update(fixed_vector<fixed::Ratio>({0.5 * kCycle_s, 0, 0}), {}, kMoving);
  }
  EXPECT_NEAR(to_double(attitude.roll()), 0.5, 1e-4);
}

TEST(AttitudeEstimator, ConvergesToGravityFastAtRestAndSlowlyInMotion) {
  for (const auto& [condition, time_constant_s] : {std::pair{kResting, 0.1}, std::pair{kMoving, 2.0}}) {
    AttitudeEstimator attitude;
    attitude.update({}, fixed_vector<fixed::Acceleration>({0, 0, kGravity}), kResting);
    const Point up = up_of(0.1, 0);
    const int cycles = static_cast<int>(time_constant_s / kCycle_s);
    for (int i = 0; i < cycles; ++i) {
      attitude.update({}, fixed_vector<fixed::Acceleration>(kGravity * up), condition);
    }
    EXPECT_NEAR(to_double(attitude.roll()), 0.1 * (1.0 - std::exp(-1.0)), 0.003);
  }
}

TEST(AttitudeEstimator, IgnoresAccelerationThatIsNotGravity) {
  AttitudeEstimator attitude;
  attitude.update({}, fixed_vector<fixed::Acceleration>({0, 0, kGravity}), kResting);
  for (const double strength : {0.0, 0.84, 1.16, 4.0, 200.0}) {
    attitude.update({}, fixed_vector<fixed::Acceleration>({strength * kGravity, 0, 0}), kMoving);
    EXPECT_EQ(attitude.up_B(), robot::kAxisZ) << strength;
  }
}

// Roll and pitch of a walk whose trunk sways in circles, about a heading that changes slowly.
struct Sway {
  static constexpr double kRate_rad_per_s = 2 * M_PI * 2.5;

  double roll(double t) const { return 0.06 * std::sin(kRate_rad_per_s * t); }
  double pitch(double t) const { return 0.1 + 0.04 * std::cos(kRate_rad_per_s * t); }
  Point up(double t) const { return up_of(roll(t), pitch(t)); }
  // Returns the rates in axes of B, rad/s.
  Point rates(double t) const {
    const double roll_rate = 0.06 * kRate_rad_per_s * std::cos(kRate_rad_per_s * t);
    const double pitch_rate = -0.04 * kRate_rad_per_s * std::sin(kRate_rad_per_s * t);
    return {roll_rate - yaw_rate * std::sin(pitch(t)),
            pitch_rate * std::cos(roll(t)) + yaw_rate * std::sin(roll(t)) * std::cos(pitch(t)),
            -pitch_rate * std::sin(roll(t)) + yaw_rate * std::cos(roll(t)) * std::cos(pitch(t))};
  }
  double yaw_rate;
};

double turned_deg(const Sway& sway, double duration_s, bool about_gravity) {
  const auto cycles = static_cast<int>(std::lround(duration_s / kCycle_s));
  double sum_rad = 0.0;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const double middle_s = (cycle + 0.5) * kCycle_s;
    Trunk trunk(sway.up(cycle * kCycle_s));
    const Point turn = trunk.turn([&](double t) { return sway.rates(t); }, cycle * kCycle_s);
    sum_rad += about_gravity ? dot(turn, sway.up(middle_s))
                             : to_double(heading_change(fixed_vector<fixed::Ratio>(turn),
                                                        fixed_vector<fixed::Ratio>(sway.up(middle_s))));
  }
  return sum_rad / kRadPerDegree;
}

TEST(HeadingChange, OfASwayingTrunkIsThatOfItsHeading) {
  for (const double yaw_rate : {0.0, 0.3, -0.3}) {
    const Sway sway{yaw_rate};
    EXPECT_NEAR(turned_deg(sway, 20.0, false), 20.0 * yaw_rate / kRadPerDegree, 0.2) << yaw_rate;
  }
}

// The reason for it: roll and pitch enclose 0.0075 rad^2 in each period of 0.4 s.
TEST(HeadingChange, OfASwayingTrunkIsNotItsTurnAboutGravity) {
  EXPECT_GT(std::abs(turned_deg(Sway{0.0}, 20.0, true)), 15.0);
}

TEST(HeadingChange, OfALyingTrunkIsItsTurnAboutGravity) {
  const Point up = up_of(0.0, 80 * kRadPerDegree);
  EXPECT_NEAR(to_double(heading_change(fixed_vector<fixed::Ratio>(0.1 * up), fixed_vector<fixed::Ratio>(up))),
              0.1, 1e-6);
}

// One minute of walking with typical rates and accelerations. The gyro has noise and the residual bias of a
// calibration, the accelerometer noise.
TEST(AttitudeEstimator, StaysWithinADegreeAndAHalfOnAWalk) {
  constexpr double kStep_rad_per_s = 2.0 * 3.14159265 / 0.6;
  std::mt19937 random(7);
  const auto noise = [&](double size) { return std::uniform_real_distribution(-size, size)(random); };
  const auto rates = [&](double t) {
    return Point{0.4 * std::cos(kStep_rad_per_s * t), 0.5 * std::cos(2 * kStep_rad_per_s * t),
                 0.3 * std::sin(kStep_rad_per_s * t)};
  };
  AttitudeEstimator attitude;
  attitude.update({}, fixed_vector<fixed::Acceleration>({0, 0, kGravity}), kResting);
  Trunk trunk({0, 0, 1});
  double worst_deg = 0.0;
  double squares = 0.0;
  for (int cycle = 0; cycle < 6000; ++cycle) {
    const double now_s = cycle * kCycle_s;
    const Point turn = trunk.turn(rates, now_s);
    const Point drift = {1e-3 * kCycle_s, -1e-3 * kCycle_s, 0};  // 0.06 deg/s
    const Point shake{1.5 * std::sin(2 * kStep_rad_per_s * now_s) + noise(0.2),
                      2.5 * std::sin(kStep_rad_per_s * now_s) + noise(0.2),
                      2.0 * std::cos(2 * kStep_rad_per_s * now_s) + noise(0.2)};
    attitude.update(fixed_vector<fixed::Ratio>(turn + drift + Point{noise(1e-4), noise(1e-4), noise(1e-4)}),
                    fixed_vector<fixed::Acceleration>(kGravity * trunk.up() + shake), kMoving);
    const double error = error_deg(attitude, trunk.up());
    worst_deg = std::max(worst_deg, error);
    squares += error * error;
  }
  EXPECT_LT(worst_deg, 1.5);
  EXPECT_LT(std::sqrt(squares / 6000), 0.7);
  EXPECT_GT(worst_deg, 0.01);
}

}  // namespace
}  // namespace koboshi::estimation
