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
  std::array<std::int32_t, 3> over(std::int64_t mass_raw) const {
    const auto length_raw = [&](std::int64_t raw) {
      return fixed::saturate<std::int32_t>(fixed::divide_rounded(raw, mass_raw));
    };
    return {length_raw(x_raw), length_raw(y_raw), length_raw(z_raw)};
  }
};

template <fixed::AnyQuantity Q>
robot::Vector<Q> to_vector(const std::array<std::int32_t, 3>& raw) {
  return {Q::from_raw(raw[0]), Q::from_raw(raw[1]), Q::from_raw(raw[2])};
}

void add(std::array<std::int32_t, 3>& sum, const std::array<std::int32_t, 3>& v) {
  for (std::size_t i = 0; i < 3; ++i) sum[i] += v[i];
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
  limbs_[limb_count_++] = {static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(end)};
  return end;
}

// Its parent is sought among the places first..end-1.
Posture::Joint Posture::make_joint(std::size_t index, std::size_t first, std::size_t end) const {
  const robot::Joint& joint = model_.joints[index];
  Joint made;
  made.index = static_cast<std::uint8_t>(index);
  made.anchor = {joint.anchor.x.raw(), joint.anchor.y.raw(), joint.anchor.z.raw()};
  for (std::size_t place = first; place < end; ++place) {
    if (joints_[place].index == joint.parent) made.parent = static_cast<std::int8_t>(place);
  }
  const std::array<Direction, 3> axes{robot::kAxisX, robot::kAxisY, robot::kAxisZ};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (joint.axis != axes[i] && joint.axis != -axes[i]) continue;
    made.axis = static_cast<std::uint8_t>(i);
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

// All by the turn of the joint's child against its parent. What turns fits, because no vector becomes longer,
// and no length in a robot comes near the end of its format.
void Posture::turn(const Joint& joint, std::span<Raw> vectors) const {
  if (joint.axis > 2) return turn_obliquely(joint, vectors);
  const auto rounded = [](std::int64_t sum_raw) {
    return static_cast<std::int32_t>(fixed::shift_rounded(sum_raw, Ratio::kFractionBits));
  };
  const auto [sine, cosine] = fixed::sin_cos(joint.angle);
  const std::int32_t s = joint.negative ? -sine.raw() : sine.raw();
  const std::int32_t c = cosine.raw();
  const std::size_t from = joint.axis == 2 ? 0 : joint.axis + 1;
  const std::size_t to = from == 2 ? 0 : from + 1;
  for (Raw& v : vectors) {
    const std::int32_t a = v[from];
    const std::int32_t b = v[to];
    v[from] = rounded(std::int64_t{c} * a - std::int64_t{s} * b);
    v[to] = rounded(std::int64_t{s} * a + std::int64_t{c} * b);
  }
}

void Posture::turn_obliquely(const Joint& joint, std::span<Raw> vectors) const {
  const robot::Rotation R = robot::rotation_about(model_.joints[joint.index].axis, joint.angle);
  for (Raw& v : vectors) {
    const Position turned = R * to_vector<Length>(v);
    v = {turned.x.raw(), turned.y.raw(), turned.z.raw()};
  }
}

void Posture::update_limb(std::size_t number) {
  const Limb limb = limbs_[number];
  // What is carried from the end to the trunk: the moment, and of a leg the sole's origin and two axes.
  std::array<Raw, 4> carried{};
  auto& [moment, sole, x, y] = carried;
  if (number < kLegs) sole[2] = -model_.feet[number].ankle_height.raw();
  x[0] = y[1] = fixed::kOne.raw();
  for (std::size_t place = limb.first; place < limb.end; ++place) {
    joints_[place].moment = joints_[place].constant;
  }
  for (std::size_t place = limb.end; place-- > limb.first;) {
    Joint& joint = joints_[place];
    moment = joint.moment;
    turn(joint, std::span(carried).first(joint.bears_foot ? 4 : 1));
    if (joint.bears_foot) add(sole, joint.anchor);
    if (joint.parent >= 0) add(joints_[static_cast<std::size_t>(joint.parent)].moment, moment);
  }
  joints_[limb.first].moment = moment;
  if (number >= kLegs) return;
  const Direction x_axis = to_vector<Ratio>(x);
  const Direction y_axis = to_vector<Ratio>(y);
  soles_[number] = {to_vector<Length>(sole), {{x_axis, y_axis, robot::cross(x_axis, y_axis)}}};
}

Position Posture::centre_of_mass(hal::Side side) const {
  Raw p_BCom = trunk_constant_;
  for (std::size_t limb = 0; limb < limb_count_; ++limb) add(p_BCom, joints_[limbs_[limb].first].moment);
  return sole(side).R_SoleB * (to_vector<Length>(p_BCom) - sole(side).p_BSole);
}

}  // namespace koboshi::balance
