#include "firmware/balance/posture.h"

#include "firmware/fixed/rounding.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::balance {

using fixed::Length;
using fixed::Ratio;
using robot::Direction;
using robot::Position;

namespace {

// Masses times lengths, in LSB of Mass times LSB of Length: 5 kg at 1 m are 2^51, of 25 links less than 2^56.
struct Moment {
  std::int64_t x_raw = 0;
  std::int64_t y_raw = 0;
  std::int64_t z_raw = 0;

  void add(std::int64_t mass_raw, const Position& p) {
    x_raw += mass_raw * p.x.raw();
    y_raw += mass_raw * p.y.raw();
    z_raw += mass_raw * p.z.raw();
  }
  Position over(std::int64_t mass_raw) const {
    const auto length = [&](std::int64_t raw) {
      return Length::from_wide_raw(fixed::divide_rounded(raw, mass_raw));
    };
    return {length(x_raw), length(y_raw), length(z_raw)};
  }
};

// c a - s b and s a + c b, rounded once. Fits, because a turn makes no vector longer and no length in a robot
// comes near the end of its format.
template <fixed::AnyQuantity Q>
void turn_plane(Ratio sine, Ratio cosine, Q& a, Q& b) {
  const std::int64_t s_raw = sine.raw();
  const std::int64_t c_raw = cosine.raw();
  const auto rounded = [](std::int64_t sum_raw) {
    return Q::from_raw(static_cast<std::int32_t>(fixed::shift_rounded(sum_raw, Ratio::kFractionBits)));
  };
  const Q first = rounded(c_raw * a.raw() - s_raw * b.raw());
  b = rounded(s_raw * a.raw() + c_raw * b.raw());
  a = first;
}

Direction cross(const Direction& a, const Direction& b) {
  return {fixed::product_sum<Ratio>(a.y, b.z, -a.z, b.y), fixed::product_sum<Ratio>(a.z, b.x, -a.x, b.z),
          fixed::product_sum<Ratio>(a.x, b.y, -a.y, b.x)};
}

}  // namespace

Posture::Posture(const robot::RobotModel& model) : model_(model) {
  if (model.joint_count == 0) return;
  std::size_t count = 0;
  const std::array roots{model.leg(hal::Side::kLeft)[0], model.leg(hal::Side::kRight)[0]};
  for (const std::size_t root : roots) count = collect_limb(count, root);
  for (std::size_t i = 0; i < model.joint_count; ++i) {
    const bool is_leg = i == roots[0] || i == roots[1];
    if (model.joints[i].parent == robot::kBase && !is_leg) count = collect_limb(count, i);
  }
  collect_constants();
}

std::size_t Posture::collect_limb(std::size_t first, std::size_t root) {
  std::size_t end = first;
  for (std::size_t step = 0; step < model_.joint_count; ++step) {
    const std::size_t index = model_.order[step];
    const Joint joint = make_joint(index, first, end);
    if (index == root || joint.parent >= 0) joints_[end++] = joint;
  }
  limbs_[limb_count_++] = {static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(end), {}};
  return end;
}

// Its parent is sought among the places first..end-1.
Posture::Joint Posture::make_joint(std::size_t index, std::size_t first, std::size_t end) const {
  const robot::Joint& joint = model_.joints[index];
  Joint made{.index = static_cast<std::uint8_t>(index)};
  for (std::size_t place = first; place < end; ++place) {
    if (joints_[place].index == joint.parent) made.parent = static_cast<std::int8_t>(place);
  }
  const std::array<Direction, 3> axes{robot::kAxisX, robot::kAxisY, robot::kAxisZ};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (joint.axis != axes[i] && joint.axis != -axes[i]) continue;
    made.axis = static_cast<Axis>(i);
    made.negative = joint.axis != axes[i];
  }
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    for (const std::size_t bearer : model_.leg(side)) made.bears_foot = made.bears_foot || bearer == index;
  }
  return made;
}

// From the ends to the trunk, each link's own moment, and what hangs on it, at its anchor.
void Posture::collect_constants() {
  std::array<std::int64_t, robot::kMaxJoints> borne_raw{};  // mass of a link and of all beyond
  std::array<Moment, robot::kMaxJoints> moments{};
  Moment trunk;
  std::int64_t total_raw = model_.base_mass.raw();
  trunk.add(total_raw, model_.base_centre_of_mass);
  for (std::size_t place = model_.joint_count; place-- > 0;) {
    const robot::Joint& joint = model_.joints[joints_[place].index];
    total_raw += joint.mass.raw();
    borne_raw[place] += joint.mass.raw();
    moments[place].add(joint.mass.raw(), joint.centre_of_mass);
    const std::int8_t parent = joints_[place].parent;
    if (parent >= 0) borne_raw[static_cast<std::size_t>(parent)] += borne_raw[place];
    (parent >= 0 ? moments[static_cast<std::size_t>(parent)] : trunk).add(borne_raw[place], joint.anchor);
  }
  trunk_constant_ = trunk.over(total_raw);
  for (std::size_t place = 0; place < model_.joint_count; ++place) {
    joints_[place].constant = moments[place].over(total_raw);
  }
}

void Posture::update(Angles angles) {
  if (limb_count_ == 0) return;
  update_limb(next_leg_, angles);
  next_leg_ = (next_leg_ + 1) % kLegs;
  if (limb_count_ == kLegs) return;
  update_limb(next_other_, angles);
  next_other_ = next_other_ + 1 < limb_count_ ? next_other_ + 1 : kLegs;
}

void Posture::update_limb(std::size_t number, Angles angles) {
  Limb& limb = limbs_[number];
  Sole sole;
  Direction& sole_x = sole.R_SoleB.rows[0];
  Direction& sole_y = sole.R_SoleB.rows[1];
  if (number < kLegs) sole.p_BSole.z = -model_.feet[number].ankle_height;
  for (std::size_t place = limb.first; place < limb.end; ++place) {
    joints_[place].moment = joints_[place].constant;
  }
  for (std::size_t place = limb.end; place-- > limb.first;) {
    const Joint& joint = joints_[place];
    const Turn turn = turn_of(joint, angles[joint.index]);
    const Position moment = turned(turn, joint.moment);
    if (joint.parent < 0) {
      limb.moment = moment;
    } else {
      Position& sum = joints_[static_cast<std::size_t>(joint.parent)].moment;
      sum = sum + moment;
    }
    if (!joint.bears_foot) continue;
    sole.p_BSole = model_.joints[joint.index].anchor + turned(turn, sole.p_BSole);
    sole_x = turned(turn, sole_x);
    sole_y = turned(turn, sole_y);
  }
  if (number >= kLegs) return;
  sole.R_SoleB.rows[2] = cross(sole_x, sole_y);
  soles_[number] = sole;
}

Posture::Turn Posture::turn_of(const Joint& joint, fixed::Angle angle) const {
  const auto [sine, cosine] = fixed::sin_cos(angle);
  return {joint.axis, joint.negative ? -sine : sine, cosine, angle, model_.joints[joint.index].axis};
}

template <fixed::AnyQuantity Q>
robot::Vector<Q> Posture::turned(const Turn& turn, const robot::Vector<Q>& v) {
  robot::Vector<Q> result = v;
  switch (turn.axis) {
    case Axis::kX:
      turn_plane(turn.sine, turn.cosine, result.y, result.z);
      break;
    case Axis::kY:
      turn_plane(turn.sine, turn.cosine, result.z, result.x);
      break;
    case Axis::kZ:
      turn_plane(turn.sine, turn.cosine, result.x, result.y);
      break;
    case Axis::kOther:
      return robot::rotation_about(turn.direction, turn.angle) * v;
  }
  return result;
}

Position Posture::centre_of_mass(hal::Side side) const {
  Position p_BCom = trunk_constant_;
  for (std::size_t limb = 0; limb < limb_count_; ++limb) p_BCom = p_BCom + limbs_[limb].moment;
  return sole(side).R_SoleB * (p_BCom - sole(side).p_BSole);
}

}  // namespace koboshi::balance
