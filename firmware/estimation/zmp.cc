#include "firmware/estimation/zmp.h"

#include "firmware/fixed/gravity.h"
#include "firmware/fixed/interpolation.h"
#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"
#include "firmware/robot/kinematics.h"

namespace koboshi::estimation {

using fixed::Force;
using fixed::Length;
using fixed::Ratio;
using fixed::Torque;
using robot::Position;

namespace {

// Converts counts; 2^15 counts are the full scale.
template <fixed::AnyQuantity Q>
Q scaled(Q full_scale, std::int16_t counts) {
  return Q::from_wide_raw(fixed::shift_rounded(std::int64_t{full_scale.raw()} * counts, 15));
}

// Returns (torque + force * arm) / load. The formats of the factors cancel to that of Length.
Length lever(Torque torque, Force force, Length arm, Force load) {
  constexpr int kShift = Force::kFractionBits + Length::kFractionBits - Torque::kFractionBits;
  const std::int64_t moment_raw =
      std::int64_t{torque.raw()} * (std::int64_t{1} << kShift) + std::int64_t{force.raw()} * arm.raw();
  return Length::from_wide_raw(fixed::divide_rounded(moment_raw, load.raw()));
}

}  // namespace

FootSensor::FootSensor(const robot::RobotModel& model, hal::Side side)
    : model_(model), side_(side), sensor_(model.feet[side].sensor) {
  if (model.joint_count == 0) return;
  const robot::Foot& geometry = model.feet[side];
  const robot::Joint& foot = model.joints[model.foot_joint(side)];
  min_load_ = fixed::product<Force>(robot::total_mass(model), fixed::kGravity) / kWeightPerMinLoad;
  if (model.ankle_kind != hal::AnkleKind::kSixAxis) return;  // cells measure the weight of the foot, too
  weight_ = fixed::product<Force>(foot.mass, fixed::kGravity);
  // The foot's frame lies in the ankle, over the sole frame's origin.
  weight_x_ = fixed::product<Torque>(foot.centre_of_mass.y - geometry.sensor.y, weight_);
  weight_y_ = -fixed::product<Torque>(foot.centre_of_mass.x - geometry.sensor.x, weight_);
}

FootSensor::Counts FootSensor::wrench(const hal::AnkleSample& sample) const {
  const auto& [f0, f1, f2] = sample.force_raw;
  const auto& [t0, t1, t2] = sample.torque_raw;
  if (model_.ankle_kind == hal::AnkleKind::kSixAxis) return {f0, f1, f2, t0, t1, t2};
  if (model_.ankle_kind == hal::AnkleKind::kPressureCells) return cell_wrench({f0, f1, f2, t0});
  Counts counts;
  counts.fill(kNoCount);
  return counts;
}

FootSensor::Counts FootSensor::cell_wrench(const std::array<std::int16_t, hal::kPressureCells>& cells) const {
  const auto& places = model_.feet[side_].cells;
  std::int32_t sum = 0;
  Torque torque_x;
  Torque torque_y;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Force force = scaled(model_.scales.ankle_force, cells[i]) / 4;
    sum += cells[i];
    torque_x += fixed::product<Torque>(places[i].y, force);
    torque_y -= fixed::product<Torque>(places[i].x, force);
  }
  const auto torque_counts = [&](Torque torque) {
    return fixed::saturate<std::int16_t>(
        fixed::divide_rounded(std::int64_t{torque.raw()} * (1 << 15), model_.scales.ankle_torque.raw()));
  };
  return {0,
          0,
          fixed::saturate<std::int16_t>(fixed::divide_rounded(sum, 4)),
          torque_counts(torque_x),
          torque_counts(torque_y),
          0};
}

FootPressure FootSensor::pressure(std::span<const std::int16_t, 6> counts) const {
  const auto force = [&](std::size_t axis) { return scaled(model_.scales.ankle_force, counts[axis]); };
  const auto torque = [&](std::size_t axis) { return scaled(model_.scales.ankle_torque, counts[3 + axis]); };
  FootPressure foot;
  foot.load = force(2) + weight_;
  foot.contact = foot.valid = foot.load >= min_load_;
  if (!foot.valid) return foot;
  const Length d = sensor_.z;
  foot.x = sensor_.x + lever(-(torque(1) + weight_y_), -force(0), d, foot.load);
  foot.y = sensor_.y + lever(torque(0) + weight_x_, -force(1), d, foot.load);
  return foot;
}

hal::BySide<FootPressure> pressures_of(const hal::BySide<bool>& contacts, Force weight) {
  const Force each = contacts[0] && contacts[1] ? weight / 2 : weight;
  hal::BySide<FootPressure> feet{};
  for (std::size_t side = 0; side < feet.size(); ++side) {
    feet[side].contact = contacts[side];
    if (contacts[side]) feet[side].load = each;
  }
  return feet;
}

Pressure combine(const hal::BySide<FootPressure>& feet, const Posture& posture) {
  const bool right = feet[1].load > feet[0].load;
  const FootPressure& main = feet[right ? 1 : 0];
  const FootPressure& other = feet[right ? 0 : 1];
  Pressure both{right ? hal::Side::kRight : hal::Side::kLeft, main.valid, main.x, main.y};
  if (!other.valid) return both;
  // From the frame of the other sole O to that of the main one M.
  const robot::Pose& X_BM = posture.X_BSole[both.frame];
  const robot::Pose& X_BO = posture.X_BSole[right ? hal::Side::kLeft : hal::Side::kRight];
  const Position p_BZmp = X_BO.p + X_BO.R * Position{other.x, other.y, {}};
  const Position p_MZmp = robot::transpose(X_BM.R) * (p_BZmp - X_BM.p);
  const Ratio share = fixed::quotient<Ratio>(other.load, main.load + other.load);
  both.x = fixed::interpolate(main.x, p_MZmp.x, share);
  both.y = fixed::interpolate(main.y, p_MZmp.y, share);
  return both;
}

}  // namespace koboshi::estimation
