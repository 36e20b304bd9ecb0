#include <algorithm>

#include "firmware/fixed/trigonometry.h"
#include "firmware/robot/leg.h"
#include "firmware/robot/leg_newton.h"

namespace koboshi::robot {
namespace {

using fixed::Angle;
using fixed::Gain;
using fixed::Length;
using fixed::product;
using fixed::Ratio;

constexpr std::array<Direction, kLegJoints> kLegAxes{kAxisZ, kAxisX, kAxisY, kAxisY, kAxisY, kAxisX};

// Distance up to which axes count as meeting. Set by hand (2026-11-21) for the rounding of the numbers in a
// robot file; a unit of a drive's position, 6 um at 1 m, is coarser.
constexpr Length kCoincidenceTolerance = Length::from_raw(16);  // 1 um

constexpr Gain kWhole = Gain::from_raw(1 << Gain::kFractionBits);
// Limit of the turn of the feet against each other, 60 degrees: beyond it, no robot walks.
constexpr std::int64_t kMaxFeet_raw = (std::int64_t{1} << 32) / 6;

bool is_near_zero(Length length) { return fixed::abs(length) <= kCoincidenceTolerance; }
bool is_near_zero(const Position& p) { return is_near_zero(p.x) && is_near_zero(p.y) && is_near_zero(p.z); }

// Indexed by LegJoint; zero for a missing hip yaw.
using Anchors = std::array<Position, kLegJoints>;

// Cosine of the angle up to which a joint's axis may be turned from that of its role: 60 degrees. The
// corrections of the balance and the bent knee rest on it. By hand, 2026-11-26: hips at 45 degrees are
// common.
constexpr Ratio kMinAlignment = Ratio::from_raw(1 << 29);

bool has_role_axis(const Joint& joint, std::size_t i) {
  return i == kHipYaw || fixed::abs(dot(kLegAxes[i], joint.axis)) >= kMinAlignment;
}

void share_yaw(const RobotModel& model, LegGeometry& leg) {
  const JointIndex hinge = leg.hinges[kHipYaw];
  leg.shares_yaw = model.is_follower(hinge) || model.leads(hinge);
  if (!model.is_follower(hinge)) return;
  const Coupling& coupling = model.coupling(hinge);
  leg.joints[kHipYaw] = coupling.leader;
  leg.yaw_multiplier = coupling.multiplier;
  leg.yaw_offset = coupling.offset;
}

bool find_joints(const RobotModel& model, hal::Side side, LegGeometry& leg) {
  for (std::size_t i = kHipYaw; i < kLegJoints; ++i) {
    const auto index = model.find_hinge(leg_role(side, i));
    leg.joints[i] = leg.hinges[i] = index.value_or(JointIndex());
    if (index && model.is_follower(*index) && i != kHipYaw) return false;
    if (index) {
      if (!has_role_axis(model.joints[*index], i)) return false;
      leg.signs[i] = leg_sign(model.joints[*index], static_cast<LegJoint>(i));
      ++leg.joint_count;
    } else if (i != kHipYaw) {
      return false;
    }
  }
  if (leg.joint_count == kLegJoints) share_yaw(model, leg);
  return true;
}

// Orders the joints from the trunk down: hip, knee, ankle.
bool find_chain(const RobotModel& model, LegGeometry& leg) {
  LinkIndex parent;
  for (std::size_t place = 0; place < leg.joint_count; ++place) {
    const std::size_t first = leg.joint_count == kLegJoints ? kHipYaw : kHipRoll;
    std::size_t next = first;
    while (next < kLegJoints && model.joints[leg.hinges[next]].parent != parent) ++next;
    if (next == kLegJoints) return false;
    const std::size_t knee_place = leg.joint_count - 3;
    const bool in_order = place < knee_place    ? next < kKnee
                          : place == knee_place ? next == kKnee
                                                : next > kKnee;
    if (!in_order) return false;
    leg.chain_joints[place] = static_cast<LegJoint>(next);
    parent = LinkIndex(leg.hinges[next]);
  }
  return true;
}

bool is_standard(const RobotModel& model, const LegGeometry& leg, const Anchors& anchors) {
  if (!leg.can_turn()) return false;
  for (std::size_t i = 0; i < kLegJoints; ++i) {
    const Direction& axis = model.joints[leg.joints[i]].axis;
    const Direction& unit = kLegAxes[i];
    if (leg.chain_joints[i] != i || (axis != unit && axis != -unit)) return false;
  }
  const Position& thigh = anchors[kKnee];
  const Position& shank = anchors[kAnklePitch];
  return is_near_zero(anchors[kHipRoll]) && is_near_zero(anchors[kHipPitch]) && is_near_zero(thigh.y) &&
         is_near_zero(shank.y) && is_near_zero(anchors[kAnkleRoll]) && thigh.z < -kCoincidenceTolerance &&
         shank.z < -kCoincidenceTolerance;
}

void measure_standard(const Anchors& anchors, LegGeometry& leg) {
  const Position& thigh = anchors[kKnee];
  const Position& shank = anchors[kAnklePitch];
  leg.p_BH_B = anchors[kHipYaw];
  leg.thigh = fixed::hypotenuse(thigh.x, thigh.z);
  leg.shank = fixed::hypotenuse(shank.x, shank.z);
  leg.thigh_tilt = fixed::atan2(-thigh.x, -thigh.z);
  leg.shank_tilt = fixed::atan2(-shank.x, -shank.z);
}

// Length and tilt of a link in the plane across the knee axis, which points to the left.
struct Segment {
  Segment(const Position& link, const Direction& axis) {
    const Length along = dot(axis, link);
    const Position across = link - Position{product<Length>(along, axis.x), product<Length>(along, axis.y),
                                            product<Length>(along, axis.z)};
    // Down in that plane is -z + axis (z . axis), and what lies behind it is axis x down.
    const Direction down{product<Ratio>(axis.z, axis.x), product<Ratio>(axis.z, axis.y),
                         product<Ratio>(axis.z, axis.z) - fixed::kOne};
    length = fixed::hypotenuse(across.x, across.y, across.z);
    tilt = fixed::atan2(dot(cross(axis, down), across), dot(down, across));
  }

  Length length;
  Angle tilt;
};

// Sums up the anchors from one joint of the chain to another one, which may be the same.
Position between(const LegGeometry& leg, const Anchors& anchors, LegJoint from, LegJoint to) {
  Position sum{};
  const auto chain = leg.chain();
  const auto begin = std::ranges::find(chain, from);
  const auto end = std::ranges::find(chain, to);
  for (auto i = begin; i != end; ++i) sum = sum + anchors[*std::next(i)];
  return sum;
}

bool measure(const RobotModel& model, const Anchors& anchors, LegGeometry& leg) {
  const LegJoint first = leg.chain_joints[0];
  leg.p_BH_B = anchors[first] + between(leg, anchors, first, kHipPitch);
  const Direction& knee_axis = model.joints[leg.joints[kKnee]].axis;
  const Direction left = leg.signs[kKnee] < 0 ? -knee_axis : knee_axis;
  const Segment thigh(between(leg, anchors, kHipPitch, kKnee), left);
  const Segment shank(between(leg, anchors, kKnee, kAnklePitch), left);
  leg.thigh = thigh.length;
  leg.shank = shank.length;
  leg.thigh_tilt = thigh.tilt;
  leg.shank_tilt = shank.tilt;
  leg.extent = leg.ankle_height;
  for (const LegJoint i : leg.chain().subspan(1))
    leg.extent += fixed::hypotenuse(anchors[i].x, anchors[i].y, anchors[i].z);
  constexpr Length kLeast = Length::from_raw(1 << 14);  // 1 mm
  if (is_near_zero(leg.thigh) || is_near_zero(leg.shank) || leg.extent < kLeast) return false;
  leg.scale = -10;
  while (Length::from_wide_raw(std::int64_t{1} << (Length::kFractionBits + leg.scale)) < leg.extent)
    ++leg.scale;
  return is_movable(model, leg);
}

}  // namespace

std::int8_t leg_sign(const Joint& joint, LegJoint place) {
  return dot(kLegAxes[place], joint.axis) < Ratio() ? std::int8_t{-1} : std::int8_t{1};
}

bool make_leg_geometry(const RobotModel& model, hal::Side side, LegGeometry& geometry) {
  geometry = {};
  geometry.ankle_height = model.feet[side].ankle_height;
  if (!find_joints(model, side, geometry) || !find_chain(model, geometry)) return false;
  Anchors anchors{};
  for (const LegJoint i : geometry.chain()) anchors[i] = model.joints[geometry.hinges[i]].anchor;
  geometry.is_standard = is_standard(model, geometry, anchors);
  if (!geometry.is_standard) return measure(model, anchors, geometry);
  measure_standard(anchors, geometry);
  return true;
}

bool can_walk(const RobotModel& model) {
  LegGeometry geometry;
  return make_leg_geometry(model, hal::Side::kLeft, geometry) &&
         make_leg_geometry(model, hal::Side::kRight, geometry);
}

bool can_turn(const RobotModel& model) {
  if (!model.find_hinge(JointRole::kLeftHipYaw) || !model.find_hinge(JointRole::kRightHipYaw)) return false;
  const std::optional<SharedYaw> shared = shared_yaw(model);
  return !shared || fixed::abs(shared->feet) >= kMinSharedYaw;
}

std::optional<SharedYaw> shared_yaw(const RobotModel& model) {
  const auto left = model.find_hinge(JointRole::kLeftHipYaw);
  const auto right = model.find_hinge(JointRole::kRightHipYaw);
  if (!left || !right || model.is_follower(*left) == model.is_follower(*right)) return std::nullopt;
  const bool left_leads = model.is_follower(*right);
  const JointIndex leader = left_leads ? *left : *right;
  const Coupling& coupling = model.coupling(left_leads ? *right : *left);
  if (coupling.leader != leader) return std::nullopt;
  const Ratio leads = model.joints[leader].axis.z;
  const Gain follows = product<Gain>(coupling.multiplier, model.joints[left_leads ? *right : *left].axis.z);
  const Gain turns = product<Gain>(leads, kWhole);
  SharedYaw shared{.joint = leader, .feet = left_leads ? turns - follows : follows - turns, .max_turn = {}};
  // Each way ends where the first of the joint's limits is: the feet of a walk turn by turns to either side.
  const Joint& joint = model.joints[leader];
  const Angle range = std::max(Angle(), std::min(-joint.lower, joint.upper));
  const std::int64_t turn_raw =
      std::int64_t{range.raw()} * fixed::abs(shared.feet).raw() >> Gain::kFractionBits;
  shared.max_turn = Angle::from_raw(static_cast<std::int32_t>(std::min(turn_raw, kMaxFeet_raw)));
  return shared;
}

}  // namespace koboshi::robot
