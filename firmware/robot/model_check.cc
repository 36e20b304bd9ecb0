#include "firmware/robot/model_check.h"

#include <algorithm>
#include <cstdint>

#include "firmware/robot/leg.h"

namespace koboshi::robot {
namespace {

using fixed::Length;
using fixed::Mass;
using fixed::Ratio;

// Tolerances of unit vectors (of a squared length of 2^60: 1e-6) and of the right-handedness of a rotation
// (3.8e-6 of an element). Set by hand (2026-11-21): 1,000 times the rounding of an image's elements, 1e-9; an
// error of that size turns no axis by more than a unit of a drive's position.
constexpr std::int64_t kUnitTolerance_raw = std::int64_t{1} << 40;
constexpr Ratio kRotationTolerance = Ratio::from_raw(1 << 12);

bool in_range(Length length) { return fixed::abs(length) <= kMaxOffset; }
bool in_range(const Position& p) { return in_range(p.x) && in_range(p.y) && in_range(p.z); }
bool in_range(Mass mass) { return mass >= Mass() && mass <= kMaxLinkMass; }
bool is_sign(std::int8_t sign) { return sign == 1 || sign == -1; }

bool is_unit(const Direction& a) {
  constexpr std::int64_t kOneSquared_raw = std::int64_t{1} << (2 * Ratio::kFractionBits);
  std::int64_t rest_raw = kOneSquared_raw;
  for (const Ratio component : {a.x, a.y, a.z}) {
    if (fixed::abs(component) > fixed::kOne) return false;
    rest_raw -= std::int64_t{component.raw()} * component.raw();
  }
  return -kUnitTolerance_raw <= rest_raw && rest_raw <= kUnitTolerance_raw;
}

bool is_rotation(const Rotation& R) {
  const auto& [a, b, c] = R.rows;
  if (!is_unit(a) || !is_unit(b) || !is_unit(c)) return false;
  const Direction a_cross_b = cross(a, b);
  const auto is_close = [](Ratio p, Ratio q) { return fixed::abs(p - q) < kRotationTolerance; };
  return is_close(a_cross_b.x, c.x) && is_close(a_cross_b.y, c.y) && is_close(a_cross_b.z, c.z);
}

// Checks the fields that every hinge has. A follower has no drive, and no mirror of its own.
bool fields_are_valid(const RobotModel& model, const Joint& joint) {
  const int count = static_cast<int>(model.hinge_count());
  return static_cast<std::size_t>(joint.role) < kRoleCount && joint.parent.raw() < count &&
         (joint.parent.is_trunk() || joint.parent.raw() >= 0) && joint.mirror < model.joint_count &&
         is_sign(joint.mirror_sign);
}

bool is_valid(const Drive& drive) {
  return is_sign(drive.sign) && drive.node_id >= 1 && drive.node_id <= 127 && drive.position_bits >= 8 &&
         drive.position_bits <= 31;
}

ModelStatus check_joint(const RobotModel& model, const Joint& joint) {
  if (!fields_are_valid(model, joint)) return ModelStatus::kBadField;
  if (!in_range(joint.anchor) || !in_range(joint.centre_of_mass) || !in_range(joint.mass) ||
      joint.max_speed <= fixed::AngularRate()) {
    return ModelStatus::kOutOfRange;
  }
  if (!is_unit(joint.axis)) return ModelStatus::kNotARotation;
  if (joint.lower > joint.upper) return ModelStatus::kLimitsReversed;
  return ModelStatus::kOk;
}

// Each joint has at most one follower, whose angle stays within half a turn at the joint's limits.
ModelStatus check_couplings(const RobotModel& model) {
  for (std::size_t i = 0; i < model.follower_count; ++i) {
    const Coupling& coupling = model.couplings[i];
    const fixed::Gain size = fixed::abs(coupling.multiplier);
    if (coupling.leader >= model.joint_count || size < kMinMultiplier || size > kMaxMultiplier)
      return ModelStatus::kBadCoupling;
    const Joint& leader = model.joints[coupling.leader];
    for (const fixed::Angle end : {leader.lower, leader.upper}) {
      const std::int64_t angle_raw =
          (std::int64_t{end.raw()} * coupling.multiplier.raw() >> fixed::Gain::kFractionBits) +
          coupling.offset.raw();
      if (angle_raw != std::int64_t{static_cast<std::int32_t>(angle_raw)}) return ModelStatus::kBadCoupling;
    }
    for (std::size_t j = 0; j < i; ++j)
      if (model.couplings[j].leader == coupling.leader) return ModelStatus::kBadCoupling;
  }
  return ModelStatus::kOk;
}

ModelStatus check_pairs(const RobotModel& model) {
  for (std::size_t i = 0; i < model.joint_count; ++i) {
    const Joint& joint = model.joints[i];
    const Joint& mirror = model.joints[joint.mirror];
    if (mirror.mirror != i || mirror.mirror_sign != joint.mirror_sign) return ModelStatus::kBadMirror;
    for (std::size_t j = 0; j < i; ++j) {
      const Joint& other = model.joints[j];
      if (joint.drive.node_id == other.drive.node_id) return ModelStatus::kDuplicateNodeId;
      if (joint.role != JointRole::kOther && joint.role == other.role) return ModelStatus::kDuplicateRole;
    }
  }
  for (std::size_t i = model.joint_count; i < model.hinge_count(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const JointRole role = model.joints[i].role;
      if (role != JointRole::kOther && role == model.joints[j].role) return ModelStatus::kDuplicateRole;
    }
  }
  return ModelStatus::kOk;
}

// Appends joints whose parent is already placed, in rounds. A round that places none has found a cycle:
// returns false.
bool sort_tree(RobotModel& model) {
  std::array<bool, kMaxJoints> placed{};
  std::size_t count = 0;
  for (std::size_t round = 0; round < model.hinge_count() && count < model.hinge_count(); ++round) {
    for (std::size_t i = 0; i < model.hinge_count(); ++i) {
      const LinkIndex parent = model.joints[i].parent;
      if (placed[i] || (!parent.is_trunk() && !placed[parent.joint()])) continue;
      placed[i] = true;
      model.order[count++] = JointIndex(i);
    }
  }
  return count == model.hinge_count();
}

bool in_range(const Foot& foot) {
  return in_range(foot.ankle_height) && in_range(foot.sensor) && in_range(foot.back) &&
         in_range(foot.front) && in_range(foot.right) && in_range(foot.left) &&
         foot.ankle_height >= Length() && foot.back < foot.front && foot.right < foot.left &&
         std::ranges::all_of(foot.cells,
                             [](const Cell& cell) { return in_range(cell.x) && in_range(cell.y); });
}

bool has_scales(const RobotModel& model) {
  const SensorScales& scales = model.scales;
  const bool measured = scales.ankle_force > fixed::Force() && scales.ankle_torque > fixed::Torque();
  return scales.gyro > fixed::AngularRate() && scales.accelerometer > fixed::Acceleration() &&
         (measured || !model.measures_loads());
}

bool has_sensors(const RobotModel& model) {
  const LinkIndex link = model.imu_link;
  return model.ankle_kind <= hal::AnkleKind::kNone &&
         (link.is_trunk() || (link.raw() >= 0 && link.joint() < model.hinge_count()));
}

// Sums in 64 bits: the masses of an unchecked image may be any.
bool in_range_together(const RobotModel& model) {
  std::int64_t sum_raw = model.base_mass.raw();
  for (std::size_t i = 0; i < model.hinge_count(); ++i) sum_raw += model.joints[i].mass.raw();
  return sum_raw <= kMaxRobotMass.raw();
}

ModelStatus check_body(const RobotModel& model) {
  if (!has_sensors(model)) return ModelStatus::kBadField;
  const bool ok = in_range(model.base_centre_of_mass) && in_range(model.base_mass) &&
                  model.base_mass > Mass() && model.body_height > Length() &&
                  model.body_height <= kMaxOffset * 2 && has_scales(model) && in_range(model.feet[0]) &&
                  in_range(model.feet[1]);
  if (!ok) return ModelStatus::kOutOfRange;
  return is_rotation(model.R_BI) ? ModelStatus::kOk : ModelStatus::kNotARotation;
}

// A leg that lacks joints can stand and move, but not walk. One that has them must be able to.
bool has_leg(const RobotModel& model, hal::Side side) {
  if (model.leg_joints(side) == 0) return false;
  for (std::size_t i = kHipRoll; i < kLegJoints; ++i)
    if (!model.find(leg_role(side, i))) return true;
  LegGeometry geometry;
  return make_leg_geometry(model, side, geometry);
}

}  // namespace

ModelStatus check_model(RobotModel& model) {
  if (const ModelStatus status = check_body(model); status != ModelStatus::kOk) return status;
  for (std::size_t i = 0; i < model.hinge_count(); ++i) {
    const ModelStatus status = check_joint(model, model.joints[i]);
    if (status != ModelStatus::kOk) return status;
    if (i < model.joint_count && !is_valid(model.joints[i].drive)) return ModelStatus::kBadField;
  }
  if (const ModelStatus status = check_couplings(model); status != ModelStatus::kOk) return status;
  if (!in_range_together(model)) return ModelStatus::kOutOfRange;
  if (const ModelStatus status = check_pairs(model); status != ModelStatus::kOk) return status;
  if (!sort_tree(model)) return ModelStatus::kCyclicTree;
  if (!has_leg(model, hal::Side::kLeft) || !has_leg(model, hal::Side::kRight)) return ModelStatus::kBadLeg;
  return ModelStatus::kOk;
}

}  // namespace koboshi::robot
