#include "firmware/robot/leg.h"

#include <algorithm>

#include "firmware/fixed/trigonometry.h"
#include "firmware/robot/leg_newton.h"

namespace koboshi::robot {
namespace {

using fixed::Angle;
using fixed::Length;
using fixed::product;
using fixed::product_sum;
using fixed::Ratio;

// Targets are clamped to this distance in each coordinate, since three squares of the full range, 2^31, would
// overflow 64 bits. Set by hand (2026-11-21): far beyond thigh and shank of kMaxOffset each; three squares of
// 2^27 stay below 2^56.
constexpr Length kMaxTargetDistance = Length::from_raw(1 << 27);  // 8 m

Length pull_in(Length length) { return std::clamp(length, -kMaxTargetDistance, kMaxTargetDistance); }

std::int64_t square_raw(Length length) { return std::int64_t{length.raw()} * length.raw(); }

Length root_of_raw(std::int64_t square) {
  if (square <= 0) return Length();
  return Length::from_wide_raw(fixed::integer_square_root_rounded(static_cast<std::uint64_t>(square)));
}

// Below this cosine of the hip roll (1.5e-5), rounding determines the yaw; it is then zero. Set by hand
// (2026-11-21): the elements of a rotation err by some 1e-8, which is 1e-3 of it.
constexpr Ratio kGimbalLock = Ratio::from_raw(1 << 14);

// Solves a standard leg joint by joint: knee, ankle, hip. Each angle is clamped before the next is computed,
// so that the next one compensates as far as it can.
class LegSolver {
 public:
  LegSolver(const RobotModel& model, const LegGeometry& leg) : model_(model), leg_(leg) {}

  LegAngles solve(const Pose& X_BSole) {
    const Position r = hip_from_ankle(X_BSole);
    bend_knee(r);
    turn_ankle_roll(r);
    turn_ankle_pitch(r);
    turn_hip(X_BSole.R);
    return result_;
  }

 private:
  // Returns p_AH in the foot's axes.
  [[nodiscard]] Position hip_from_ankle(const Pose& X_BSole) const {
    const Position p_SoleH_B = leg_.p_BH_B - X_BSole.p;
    const Position pulled_in{pull_in(p_SoleH_B.x), pull_in(p_SoleH_B.y), pull_in(p_SoleH_B.z)};
    Position r = transpose(X_BSole.R) * pulled_in;
    r.z -= leg_.ankle_height;
    return r;
  }

  // tan(k/2)^2 = ((A+B)^2 - C^2) / (C^2 - (A-B)^2), from the law of cosines.
  void bend_knee(const Position& r) {
    const std::int64_t distance_squared = square_raw(r.x) + square_raw(r.y) + square_raw(r.z);
    const Length longest = leg_.thigh + leg_.shank;
    const Length shortest = fixed::abs(leg_.thigh - leg_.shank);
    const Length far = root_of_raw(square_raw(longest) - distance_squared);
    const Length near = root_of_raw(distance_squared - square_raw(shortest));
    const Angle below_quarter = Angle::from_raw(fixed::kQuarterTurn.raw() - 1);
    const Angle wanted = std::min(fixed::atan2(far, near), below_quarter) * 2;
    if (distance_squared > square_raw(longest + kReachTolerance) || distance_squared < square_raw(shortest)) {
      result_.reached = false;
    }
    const Angle tilt = leg_.thigh_tilt - leg_.shank_tilt;
    knee_ = set_exactly(kKnee, wanted + tilt) - tilt;
  }

  void turn_ankle_roll(const Position& r) {
    Angle wanted = fixed::atan2(r.y, r.z);
    const bool hip_is_below = fixed::abs(wanted) > fixed::kQuarterTurn;
    if (hip_is_below) wanted += fixed::kQuarterTurn * 2;
    roll_ = fixed::sin_cos(set(kAnkleRoll, wanted));
    if (fixed::abs(product_sum<Length>(r.y, roll_.cosine, -r.z, roll_.sine)) > kReachTolerance) {
      result_.reached = false;
    }
  }

  void turn_ankle_pitch(const Position& r) {
    const Angle lean = fixed::atan2(-r.x, product_sum<Length>(r.y, roll_.sine, r.z, roll_.cosine));
    ankle_pitch_ = set_exactly(kAnklePitch, lean - from_shank_to_hip() + leg_.shank_tilt) - leg_.shank_tilt;
  }

  // B + A e^(i k) = e^(i k/2) ((A + B) cos(k/2) + i (A - B) sin(k/2)): half the bend, and more for a thigh
  // that is longer than the shank.
  [[nodiscard]] Angle from_shank_to_hip() const {
    const Angle half = knee_ / 2;
    if (leg_.thigh == leg_.shank) return half;
    const auto [s, c] = fixed::sin_cos(half);
    return half + fixed::atan2(product<Length>(leg_.thigh - leg_.shank, s),
                               product<Length>(leg_.thigh + leg_.shank, c));
  }

  // A row of R_BThigh = R_BSole Rx(-ankle roll) Ry(-(knee + ankle pitch)). Neither matrix is written out,
  // since two thirds of their elements are zero or one.
  [[nodiscard]] Direction row_of_thigh(const Direction& sole, fixed::SineCosine pitch) const {
    const Ratio z = product_sum<Ratio>(sole.y, roll_.sine, sole.z, roll_.cosine);
    return {product_sum<Ratio>(sole.x, pitch.cosine, z, pitch.sine), across_shank(sole),
            product_sum<Ratio>(z, pitch.cosine, -sole.x, pitch.sine)};
  }
  [[nodiscard]] Ratio across_shank(const Direction& sole) const {
    return product_sum<Ratio>(sole.y, roll_.cosine, -sole.z, roll_.sine);
  }

  // R_BThigh = Rz(yaw) Rx(roll) Ry(pitch). Pitch is what is left after yaw and roll, so that it fits them
  // where they are ill-conditioned.
  void turn_hip(const Rotation& R_BSole) {
    const fixed::SineCosine bend = fixed::sin_cos(knee_ + ankle_pitch_);
    const Direction x = row_of_thigh(R_BSole.rows[0], bend);
    const Direction y = row_of_thigh(R_BSole.rows[1], bend);
    const Ratio up = across_shank(R_BSole.rows[2]);
    const bool locked = fixed::abs(x.y) < kGimbalLock && fixed::abs(y.y) < kGimbalLock;
    const Angle yaw = set(kHipYaw, locked ? Angle() : fixed::atan2(-x.y, y.y));
    const auto [s, c] = fixed::sin_cos(yaw);
    if (fixed::abs(product_sum<Ratio>(c, x.y, s, y.y)) > kTurnTolerance) result_.reached = false;
    set_exactly(kHipRoll, fixed::atan2(up, product_sum<Ratio>(c, y.y, -s, x.y)));
    const Angle pitch = fixed::atan2(product_sum<Ratio>(c, x.z, s, y.z), product_sum<Ratio>(c, x.x, s, y.x));
    set_exactly(kHipPitch, pitch - leg_.thigh_tilt);
  }

  // Clamps an angle about +z, +x or +y to the limits of a joint that may turn the other way. Returns what is
  // left of it.
  Angle set(LegJoint index, Angle wanted) {
    const bool opposite = leg_.signs[index] < 0;
    const Angle angle = clamp_to_limits(model_.joints[leg_.joints[index]], opposite ? -wanted : wanted);
    result_.angles[index] = angle;
    return opposite ? -angle : angle;
  }

  Angle set_exactly(LegJoint index, Angle wanted) {
    const Angle angle = set(index, wanted);
    if (fixed::abs(angle - wanted) > kLimitTolerance) result_.reached = false;
    return angle;
  }

  const RobotModel& model_;
  const LegGeometry& leg_;
  LegAngles result_{.angles = {}, .reached = true, .missing_heading = {}};
  Angle knee_;              // of the equivalent leg without tilts
  fixed::SineCosine roll_;  // of the ankle
  Angle ankle_pitch_;       // of the equivalent leg without tilts
};

}  // namespace

LegAngles leg_inverse_kinematics(const RobotModel& model, const LegGeometry& leg, const Pose& X_BSole,
                                 const LegAngles* last, FirstSolution first, Angle yaw) {
  if (leg.is_standard) return LegSolver(model, leg).solve(X_BSole);
  return newton_leg_inverse_kinematics(model, leg, X_BSole, last, first, yaw);
}

}  // namespace koboshi::robot
