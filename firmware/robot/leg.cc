#include "firmware/robot/leg.h"

#include <algorithm>

#include "firmware/fixed/trigonometry.h"

namespace koboshi::robot {
namespace {

using fixed::Angle;
using fixed::Length;
using fixed::product;
using fixed::product_sum;
using fixed::Ratio;

enum LegJoint : std::size_t { kHipYaw, kHipRoll, kHipPitch, kKnee, kAnklePitch, kAnkleRoll };

constexpr std::array<Direction, kLegJoints> kLegAxes{kAxisZ, kAxisX, kAxisY, kAxisY, kAxisY, kAxisX};

// Axes that should meet may miss each other by this much, rounding of the model file's numbers.
constexpr Length kMeet = Length::from_raw(16);  // 1 um

bool is_near_zero(Length length) { return fixed::abs(length) <= kMeet; }
bool is_near_zero(const Position& p) { return is_near_zero(p.x) && is_near_zero(p.y) && is_near_zero(p.z); }

// +1 or -1 if `axis` is that multiple of `unit`, else 0.
std::int8_t sign_along(const Direction& axis, const Direction& unit) {
  if (axis == unit) return 1;
  return axis == -unit ? std::int8_t{-1} : std::int8_t{0};
}

// Beyond this a target is pulled in along its direction's octant: squares of more would not fit, and no leg
// is as long.
constexpr Length kFarAway = Length::from_raw(1 << 27);  // 8 m

Length pull_in(Length length) { return std::clamp(length, -kFarAway, kFarAway); }

std::int64_t square_raw(Length length) { return std::int64_t{length.raw()} * length.raw(); }

Length root_of_raw(std::int64_t square) {
  if (square <= 0) return Length();
  return Length::from_wide_raw(fixed::integer_square_root_rounded(static_cast<std::uint64_t>(square)));
}

struct Knee {
  Angle angle;  // 0 stretched, to just below half a turn
  bool reached = false;
};

// tan(k/2)^2 = ((A+B)^2 - C^2) / (C^2 - (A-B)^2), from the law of cosines.
Knee bend_knee(const LegGeometry& leg, const Position& r) {
  const std::int64_t distance_squared = square_raw(r.x) + square_raw(r.y) + square_raw(r.z);
  const std::int64_t below_longest = square_raw(leg.thigh + leg.shank) - distance_squared;
  const std::int64_t above_shortest = distance_squared - square_raw(leg.thigh - leg.shank);
  const Angle half = fixed::atan2(root_of_raw(below_longest), root_of_raw(above_shortest));
  const Angle widest = Angle::from_raw(fixed::kQuarterTurn.raw() - 1);
  return {std::min(half, widest) * 2, below_longest >= 0 && above_shortest >= 0};
}

struct HipAngles {
  Angle yaw;
  Angle roll;
  Angle pitch;
};

// R = Rz(yaw) Rx(roll) Ry(pitch). Pitch is what is left after yaw and roll, so that it fits them where they
// are ill-conditioned.
HipAngles decompose_hip(const Rotation& R) {
  const auto& [x, y, z] = R.rows;
  const Angle yaw = fixed::atan2(-x.y, y.y);
  const auto [s, c] = fixed::sin_cos(yaw);
  const Angle roll = fixed::atan2(z.y, product_sum<Ratio>(c, y.y, -s, x.y));
  const Angle pitch = fixed::atan2(product_sum<Ratio>(c, x.z, s, y.z), product_sum<Ratio>(c, x.x, s, y.x));
  return {yaw, roll, pitch};
}

}  // namespace

bool make_leg_geometry(const RobotModel& model, hal::Side side, LegGeometry& geometry) {
  const bool left = side == hal::Side::kLeft;
  const auto first = static_cast<std::size_t>(left ? JointRole::kLeftHipYaw : JointRole::kRightHipYaw);
  std::array<Position, kLegJoints> anchors;
  for (std::size_t i = 0; i < kLegJoints; ++i) {
    const auto index = model.find(static_cast<JointRole>(first + i));
    if (!index) return false;
    const Joint& joint = model.joints[*index];
    const std::int8_t parent = i == 0 ? kBase : static_cast<std::int8_t>(geometry.joints[i - 1]);
    geometry.joints[i] = *index;
    geometry.signs[i] = sign_along(joint.axis, kLegAxes[i]);
    if (joint.parent != parent || geometry.signs[i] == 0) return false;
    anchors[i] = joint.anchor;
  }
  const Position& thigh = anchors[kKnee];
  const Position& shank = anchors[kAnklePitch];
  if (!is_near_zero(anchors[kHipRoll]) || !is_near_zero(anchors[kHipPitch]) || !is_near_zero(thigh.y) ||
      !is_near_zero(shank.y) || !is_near_zero(anchors[kAnkleRoll]) || thigh.z >= -kMeet ||
      shank.z >= -kMeet) {
    return false;
  }
  geometry.p_BH_B = anchors[kHipYaw];
  geometry.thigh = fixed::hypotenuse(thigh.x, thigh.z);
  geometry.shank = fixed::hypotenuse(shank.x, shank.z);
  geometry.thigh_tilt = fixed::atan2(-thigh.x, -thigh.z);
  geometry.shank_tilt = fixed::atan2(-shank.x, -shank.z);
  geometry.ankle_height = model.feet[static_cast<std::size_t>(side)].ankle_height;
  return true;
}

LegAngles leg_inverse_kinematics(const RobotModel& model, const LegGeometry& leg, const Pose& X_BSole) {
  // r: from the ankle to the hip, in the foot's axes.
  const Position p_HSole_B = X_BSole.p - leg.p_BH_B;
  const Position p_SoleH_B{-pull_in(p_HSole_B.x), -pull_in(p_HSole_B.y), -pull_in(p_HSole_B.z)};
  Position r = transpose(X_BSole.R) * p_SoleH_B;
  r.z -= leg.ankle_height;

  const Knee knee = bend_knee(leg, r);
  const auto [sin_knee, cos_knee] = fixed::sin_cos(knee.angle);
  const Angle alpha =
      fixed::atan2(product<Length>(leg.thigh, sin_knee),  // at the ankle, from AH to the shank
                   leg.shank + product<Length>(leg.thigh, cos_knee));

  Angle ankle_roll = fixed::atan2(r.y, r.z);
  const bool wrapped = fixed::abs(ankle_roll) > fixed::kQuarterTurn;  // the hip is lower than the ankle
  if (wrapped) ankle_roll += fixed::kQuarterTurn * 2;
  const auto [sin_roll, cos_roll] = fixed::sin_cos(ankle_roll);
  const Angle lean = fixed::atan2(-r.x, product_sum<Length>(r.y, sin_roll, r.z, cos_roll));
  const Angle ankle_pitch = lean - alpha;

  const Rotation R_BThigh =
      X_BSole.R * rotation_about(kAxisX, -ankle_roll) * rotation_about(kAxisY, -(knee.angle + ankle_pitch));
  const HipAngles hip = decompose_hip(R_BThigh);

  LegAngles result;
  result.reached = knee.reached;
  result.angles = {hip.yaw,
                   hip.roll,
                   hip.pitch - leg.thigh_tilt,
                   knee.angle + leg.thigh_tilt - leg.shank_tilt,
                   ankle_pitch + leg.shank_tilt,
                   ankle_roll};
  for (std::size_t i = 0; i < kLegJoints; ++i) {
    const Angle wanted = leg.signs[i] < 0 ? -result.angles[i] : result.angles[i];
    result.angles[i] = clamp_to_limits(model.joints[leg.joints[i]], wanted);
    if (result.angles[i] != wanted) result.reached = false;
  }
  return result;
}

}  // namespace koboshi::robot
