#include "firmware/estimation/attitude.h"

#include "firmware/fixed/gravity.h"
#include "firmware/fixed/literals.h"
#include "firmware/fixed/radians.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::estimation {

using namespace fixed::literals;
using fixed::Ratio;
using robot::Direction;

namespace {

// Bounds of |force|^2 / g^2, 0.85^2 and 1.15^2. Outside, the trunk accelerates too much for its specific
// force to point up. Set by hand (2026-11-21); not tuned.
constexpr Ratio kMinSquare = 0.7225_ratio;
constexpr Ratio kMaxSquare = 1.3225_ratio;
constexpr Ratio kMinLevelSquare = 0.25_ratio;  // cos^2 of 60 degrees
// k: the cycle of 10 ms over time constants of 2 s and of 0.1 s.
constexpr Ratio kHalf = 0.5_ratio;
constexpr Ratio kMovingShare = 0.005_ratio;
constexpr Ratio kRestingShare = 0.1_ratio;

Direction scaled(Ratio factor, const Direction& v) {
  return {fixed::product<Ratio>(factor, v.x), fixed::product<Ratio>(factor, v.y),
          fixed::product<Ratio>(factor, v.z)};
}

bool is_near_one(const Direction& force) {
  for (const Ratio component : {force.x, force.y, force.z}) {
    if (fixed::abs(component) > kMaxSquare) return false;
  }
  const Ratio square = robot::dot(force, force);
  return square >= kMinSquare && square <= kMaxSquare;
}

// Returns force / g; saturates at 2.
Direction in_g(const AttitudeEstimator::Acceleration& force_B) {
  return {fixed::product<Ratio>(force_B.x, fixed::kInverseGravity),
          fixed::product<Ratio>(force_B.y, fixed::kInverseGravity),
          fixed::product<Ratio>(force_B.z, fixed::kInverseGravity)};
}

}  // namespace

fixed::Angle roll_of(const Direction& up_B) { return fixed::atan2(up_B.y, up_B.z); }

fixed::Angle pitch_of(const Direction& up_B) {
  return fixed::atan2(-up_B.x, fixed::hypotenuse(up_B.y, up_B.z));
}

// The yaw rate of the angles yaw, pitch, roll by the rates in axes of B: (w_y sin roll + w_z cos roll) / cos
// pitch (J. Diebel, Representing Attitude, 2006, Euler angle rates), with up_B = (-sin pitch, sin roll cos
// pitch, cos roll cos pitch).
fixed::Angle heading_change(const robot::Vector<Ratio>& turn_B_rad, const Direction& up_B) {
  const Ratio level_square = fixed::product_sum<Ratio>(up_B.y, up_B.y, up_B.z, up_B.z);
  if (level_square < kMinLevelSquare) return fixed::from_rad(robot::dot(turn_B_rad, up_B));
  const Ratio turn = fixed::product_sum<Ratio>(turn_B_rad.y, up_B.y, turn_B_rad.z, up_B.z);
  return fixed::from_rad(fixed::quotient<Ratio>(turn, level_square));
}

void AttitudeEstimator::update(const robot::Vector<Ratio>& turn_B_rad, const Acceleration& force_B,
                               Condition condition) {
  turn(turn_B_rad);
  correct(force_B, condition);
  normalise();
  roll_ = roll_of(up_B_);
  pitch_ = pitch_of(up_B_);
}

// A vector v that is fixed in the world turns by -t in axes of B: to second order, v - t x v + t x (t x v) /
// 2.
void AttitudeEstimator::turn(const robot::Vector<Ratio>& turn_B_rad) {
  const Direction first = robot::cross(turn_B_rad, up_B_);
  const Direction half = scaled(kHalf, first);
  up_B_ = up_B_ - first + robot::cross(turn_B_rad, half);
}

void AttitudeEstimator::correct(const Acceleration& force_B, Condition condition) {
  const Direction force = in_g(force_B);
  if (!is_near_one(force)) return;
  if (!known_) {
    known_ = true;
    up_B_ = force;
    // Four Newton steps converge to an LSB or two from 15 % off.
    for (int step = 0; step < 4; ++step) normalise();
    return;
  }
  // The component along up_B changes the length only, which `normalise` restores.
  up_B_ = up_B_ + scaled(condition == Condition::kResting ? kRestingShare : kMovingShare, force - up_B_);
}

// One Newton step of the inverse square root of s = |v|^2: v (3 - s) / 2.
void AttitudeEstimator::normalise() {
  const Ratio excess = robot::dot(up_B_, up_B_) - fixed::kOne;
  up_B_ = up_B_ - scaled(fixed::product<Ratio>(kHalf, excess), up_B_);
}

}  // namespace koboshi::estimation
