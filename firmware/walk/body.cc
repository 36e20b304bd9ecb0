#include "firmware/walk/body.h"

#include <algorithm>

#include "firmware/fixed/literals.h"
#include "firmware/fixed/trigonometry.h"
#include "firmware/robot/kinematics.h"

namespace koboshi::walk {

using fixed::Angle;
using fixed::Length;
using fixed::Mass;
using fixed::product;
using fixed::product_sum;
using fixed::Ratio;
using fixed::SineCosine;
using robot::Position;
using namespace fixed::literals;
using enum robot::LegJoint;

namespace {

// Limit of the change of a joint that is predicted for a cycle. By hand, 2026-11-27: 870 deg/s, above the
// speed of any leg joint of a walk.
constexpr Angle kMaxPrediction = 8.7_deg;

Position scaled(const Position& p, Ratio factor) {
  return {product<Length>(p.x, factor), product<Length>(p.y, factor), product<Length>(p.z, factor)};
}

// R_SupportB v for a trunk B that is pitched forward and then yawed to the left.
Position from_trunk(const Position& v, SineCosine yaw, SineCosine pitch) {
  const Length forward = product_sum<Length>(v.x, pitch.cosine, v.z, pitch.sine);
  return {product_sum<Length>(forward, yaw.cosine, -v.y, yaw.sine),
          product_sum<Length>(forward, yaw.sine, v.y, yaw.cosine),
          product_sum<Length>(v.z, pitch.cosine, -v.x, pitch.sine)};
}

Position into_trunk(const Position& v, SineCosine yaw, SineCosine pitch) {
  const Length forward = product_sum<Length>(v.x, yaw.cosine, v.y, yaw.sine);
  return {product_sum<Length>(forward, pitch.cosine, -v.z, pitch.sine),
          product_sum<Length>(v.y, yaw.cosine, -v.x, yaw.sine),
          product_sum<Length>(v.z, pitch.cosine, forward, pitch.sine)};
}

// R_BSole of a level sole that is yawed to the left by `yaw` relative to the trunk.
robot::Rotation level_in_trunk(Angle yaw, SineCosine pitch) {
  const auto [s, c] = fixed::sin_cos(yaw);
  return {{robot::Direction{product<Ratio>(pitch.cosine, c), -product<Ratio>(pitch.cosine, s), -pitch.sine},
           robot::Direction{s, c, Ratio()},
           robot::Direction{product<Ratio>(pitch.sine, c), -product<Ratio>(pitch.sine, s), pitch.cosine}}};
}

Angle signed_by(std::int8_t sign, Angle angle) { return sign < 0 ? -angle : angle; }

Position at_height(Point p, Length height) { return {p.x, p.y, height}; }

constexpr fixed::Gain kWhole = 1.0_gain;

// Masses as shares of the robot's mass: weights of the sum that is its CoM.
class Shares {
 public:
  explicit Shares(const robot::RobotModel& model) : total_(robot::total_mass(model)) {}
  [[nodiscard]] Ratio of(Mass mass) const { return fixed::quotient<Ratio>(mass, total_); }

 private:
  Mass total_;
};

}  // namespace

Body::Body(const robot::RobotModel& model) : model_(model) {
  if (model.joint_count == 0) return;
  const Shares shares(model);
  // At joint zero all links have the trunk's axes, so that each is where the anchors down to it add up to.
  std::array<Position, robot::kMaxJoints> p_BLinks;
  Position centre = scaled(model.base_centre_of_mass, shares.of(model.base_mass));
  for (std::size_t step = 0; step < model.hinge_count(); ++step) {
    const robot::JointIndex i = model.order[step];
    const robot::Joint& joint = model.joints[i];
    p_BLinks[i] = joint.parent.is_trunk() ? joint.anchor : p_BLinks[joint.parent.joint()] + joint.anchor;
    centre = centre + scaled(p_BLinks[i] + joint.centre_of_mass, shares.of(joint.mass));
  }
  Ratio both_legs;
  Position soles{};
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    robot::LegGeometry& leg = legs_[side];
    if (!robot::make_leg_geometry(model, side, leg)) return;
    Position p_BSole = p_BLinks[model.foot_joint(side)];
    p_BSole.z -= leg.ankle_height;
    for (const robot::LegJoint place_in_leg : leg.chain()) {
      const robot::JointIndex i = leg.hinges[place_in_leg];
      const Length place = p_BLinks[i].z + model.joints[i].centre_of_mass.z;
      const Ratio along = fixed::quotient<Ratio>(leg.p_BH_B.z - place, leg.p_BH_B.z - p_BSole.z);
      both_legs += product<Ratio>(shares.of(model.joints[i].mass), along);
    }
    soles = soles + p_BSole;
  }
  foot_share_ = both_legs / 2;
  inverse_share_ = fixed::quotient<Ratio>(fixed::kOne, fixed::kOne - both_legs);
  constant_B_ = hanging_B_ = centre - scaled(soles, foot_share_);
  has_legs_ = true;
  if (const auto shared = robot::shared_yaw(model)) {
    shared_yaw_ = shared->joint;
    max_turn_ = shared->max_turn;
    turns_feet_ = fixed::abs(shared->feet) >= robot::kMinSharedYaw;
    if (turns_feet_) per_turn_ = fixed::quotient<fixed::Gain>(kWhole, shared->feet);
  }
  find_upper_body();
}

// The joints of which none is carried by a leg, and their constant moments.
void Body::find_upper_body() {
  std::uint32_t legs = model_.leg_joints();
  for (std::size_t i = model_.joint_count; i < model_.hinge_count(); ++i) {
    const robot::JointRole role = model_.joints[i].role;
    if (role >= robot::JointRole::kLeftHipYaw && role <= robot::JointRole::kRightAnkleRoll) legs |= 1u << i;
  }
  for (std::size_t step = 0; step < model_.hinge_count(); ++step) {
    const robot::JointIndex i = model_.order[step];
    const robot::LinkIndex parent = model_.joints[i].parent;
    const bool on_upper_body = parent.is_trunk() || (upper_joints_ >> parent.joint() & 1u) != 0;
    if (on_upper_body && (legs >> i & 1u) == 0) upper_joints_ |= 1u << i;
  }
  const Shares shares(model_);
  std::array<Ratio, robot::kMaxJoints> carried{};
  for (std::size_t step = model_.hinge_count(); step-- > 0;) {
    const robot::JointIndex i = model_.order[step];
    if ((upper_joints_ >> i & 1u) == 0) continue;
    const robot::Joint& joint = model_.joints[i];
    const Ratio share = shares.of(joint.mass);
    carried[i] += share;
    moments_[i] = moments_[i] + scaled(joint.centre_of_mass, share);
    if (joint.parent.is_trunk()) continue;
    const robot::JointIndex parent = joint.parent.joint();
    carried[parent] += carried[i];
    moments_[parent] = moments_[parent] + scaled(joint.anchor, carried[i]);
  }
  const std::array<Angle, robot::kMaxJoints> zero{};
  hanging_moment_ = upper_body_moment(zero);
}

Position Body::upper_body_moment(std::span<const Angle> angles) const {
  Position trunk{};
  std::array<Position, robot::kMaxJoints> moments = moments_;
  for (std::size_t step = model_.hinge_count(); step-- > 0;) {
    const robot::JointIndex i = model_.order[step];
    if ((upper_joints_ >> i & 1u) == 0) continue;
    const robot::Joint& joint = model_.joints[i];
    Position& carrier = joint.parent.is_trunk() ? trunk : moments[joint.parent.joint()];
    carrier = carrier + robot::rotation_about(joint.axis, model_.hinge_angle(angles, i)) * moments[i];
  }
  return trunk;
}

void Body::set_upper_body(std::span<const Angle> angles) {
  constant_B_ = hanging_B_;
  if (!angles.empty()) constant_B_ = constant_B_ + (upper_body_moment(angles) - hanging_moment_);
}

void Body::begin_in_parts() {
  is_solved_ = false;
  yaw_ = yaw_before_ = yaw_change_ = Angle();
  const bool in_closed_form = legs_[0].is_standard && legs_[1].is_standard;
  parts_left_ = in_closed_form ? 0 : robot::kFirstSolutionParts;
}

// Extrapolates the last three solutions with their second difference: what is left is the third difference of
// the plan, a third of a millimetre at the most in the swing of a foot, which one Newton step removes.
robot::LegAngles Body::predict(std::size_t side) {
  robot::LegAngles guess = solutions_[side];
  for (std::size_t i = 0; i < guess.angles.size(); ++i) {
    Angle& before = before_[side].angles[i];
    Angle& last_change = changes_[side].angles[i];
    const Angle change = guess.angles[i] - before;
    const Angle next = change + (change - last_change);
    before = guess.angles[i];
    last_change = change;
    if (is_complete()) guess.angles[i] += std::clamp(next, -kMaxPrediction, kMaxPrediction);
  }
  return guess;
}

// The feet's headings are nearly linear in the yaw, and a Newton step with the slope at joint zero leaves
// little. The next cycle's yaw is extrapolated as the other joints' angles are.
void Body::follow_headings() {
  if (!turns_feet_ || !is_complete()) return;
  const Angle missing = solutions_[0].missing_heading - solutions_[1].missing_heading;
  const Angle found = yaw_ + product<Angle>(std::clamp(missing, -kMaxPrediction, kMaxPrediction), per_turn_);
  const Angle change = found - yaw_before_;
  const Angle next = is_solved_ ? change + (change - yaw_change_) : Angle();
  yaw_before_ = found;
  yaw_change_ = change;
  yaw_ = robot::clamp_to_limits(model_.joints[*shared_yaw_],
                                found + std::clamp(next, -kMaxPrediction, kMaxPrediction));
}

void Body::solve(const Stance& stance, const Compliance& compliance, std::span<Angle> targets) {
  const SineCosine yaw = fixed::sin_cos(stance.yaw);
  const SineCosine pitch = fixed::sin_cos(stance.pitch);
  const Position feet =
      at_height(stance.soles[0].p + stance.soles[1].p, stance.heights[0] + stance.heights[1]);
  const Position p_SupportB =
      scaled(stance.centre_of_mass - from_trunk(constant_B_, yaw, pitch) - scaled(feet, foot_share_),
             inverse_share_);
  for (std::size_t side = 0; side < legs_.size(); ++side) {
    const robot::LegGeometry& geometry = legs_[side];
    const Foothold& sole = stance.soles[side];
    const Position p_SupportSole = at_height(sole.p, stance.heights[side]);
    robot::LegAngles& solution = solutions_[side];
    const robot::Pose X_BSole{.R = level_in_trunk(sole.yaw - stance.yaw, pitch),
                              .p = into_trunk(p_SupportSole - p_SupportB, yaw, pitch)};
    const bool follows = is_solved_ && !geometry.is_standard;
    const robot::LegAngles guess = follows ? predict(side) : robot::LegAngles();
    solution = robot::leg_inverse_kinematics(
        model_, geometry, X_BSole, follows ? &guess : nullptr,
        is_complete() ? robot::FirstSolution::kAtOnce : robot::FirstSolution::kInParts, yaw_);
    robot::LegAngles leg = solution;
    compensate(side, stance, compliance, p_SupportB + from_trunk(geometry.p_BH_B, yaw, pitch), leg);
    leg.angles[kAnkleRoll] += signed_by(geometry.signs[kAnkleRoll], stance.tilts[side].roll);
    leg.angles[kAnklePitch] += signed_by(geometry.signs[kAnklePitch], stance.tilts[side].pitch);
    for (const robot::LegJoint i : geometry.chain()) targets[geometry.joints[i]] = leg.angles[i];
  }
  follow_headings();
  is_solved_ = true;
  if (!is_complete()) --parts_left_;
}

// Adds the sag of the servos to the targets, so that the loaded joints end up at their planned angles. The
// ground's upward force through the ZMP turns a joint by force times horizontal lever; at compliance per
// weight and metre that is share * lever * compliance, and the target goes as far the other way. Neglected:
// the weight below the joint, and the yaw of the sole relative to the frame.
void Body::compensate(std::size_t side, const Stance& stance, const Compliance& compliance,
                      const Position& p_SH, robot::LegAngles& leg) const {
  const robot::LegGeometry& geometry = legs_[side];
  const Ratio share = stance.load_shares[side];
  if (share == Ratio()) return;
  const Point sole = stance.soles[side].p;
  // In double support each foot bears its share about its own place.
  const Point zmp = share == fixed::kOne ? stance.zmp : sole;
  const Angle lean = geometry.shank_tilt - signed_by(geometry.signs[kAnklePitch], leg.angles[kAnklePitch]);
  const Length knee = sole.x + product<Length>(geometry.shank, fixed::sin(lean));
  const auto turn = [&](robot::LegJoint joint, Length lever, Angle of_a_metre) {
    leg.angles[joint] -= signed_by(geometry.signs[joint], product<Angle>(lever, of_a_metre));
  };
  const Angle pitch = product<Angle>(share, compliance.pitch);
  const Angle roll = product<Angle>(share, compliance.roll);
  turn(kHipPitch, p_SH.x - zmp.x, pitch);
  turn(kKnee, knee - zmp.x, pitch);
  turn(kAnklePitch, sole.x - zmp.x, pitch);
  turn(kHipRoll, zmp.y - p_SH.y, roll);
  turn(kAnkleRoll, zmp.y - sole.y, roll);
}

}  // namespace koboshi::walk
