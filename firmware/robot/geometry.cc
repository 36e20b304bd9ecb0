#include "firmware/robot/geometry.h"

#include "firmware/fixed/trigonometry.h"

namespace koboshi::robot {

using fixed::Angle;
using fixed::product;
using fixed::Ratio;

Rotation operator*(const Rotation& R_AB, const Rotation& R_BC) {
  const Rotation R_CB = transpose(R_BC);
  return {{R_CB * R_AB.rows[0], R_CB * R_AB.rows[1], R_CB * R_AB.rows[2]}};
}

Pose operator*(const Pose& X_AB, const Pose& X_BC) { return {X_AB.R * X_BC.R, X_AB.p + X_AB.R * X_BC.p}; }

namespace {

using Component = Ratio Direction::*;
constexpr std::array<Component, 3> kComponents{&Direction::x, &Direction::y, &Direction::z};
constexpr std::array<std::size_t, 3> kNext{1, 2, 0};
constexpr std::size_t kOblique = 3;

bool is_unit(Ratio component) { return component == fixed::kOne || component == -fixed::kOne; }

// Returns which axis of the base an axis lies along, to the bit; kOblique if along none.
std::size_t base_axis(const Direction& axis) {
  const std::size_t i = axis.x != Ratio() ? 0 : axis.y != Ratio() ? 1 : 2;
  const bool others_are_zero = axis.*kComponents[kNext[i]] == Ratio() && (i != 0 || axis.z == Ratio());
  return others_are_zero && is_unit(axis.*kComponents[i]) ? i : kOblique;
}

Direction scaled_by(Ratio factor, const Direction& v) {
  return {product<Ratio>(factor, v.x), product<Ratio>(factor, v.y), product<Ratio>(factor, v.z)};
}

Ratio from_sum_raw(std::int64_t sum_raw) { return fixed::from_product_raw<Ratio, Ratio, Ratio>(sum_raw); }

// Two columns mix and one stays.
void turn_about_base_axis(Rotation& R, std::size_t i, Ratio s, Ratio c) {
  const Component first = kComponents[kNext[i]];
  const Component second = kComponents[kNext[kNext[i]]];
  for (Direction& row : R.rows) {
    const std::int64_t p_raw = (row.*first).raw();
    const std::int64_t q_raw = (row.*second).raw();
    row.*first = from_sum_raw(p_raw * c.raw() + q_raw * s.raw());
    row.*second = from_sum_raw(q_raw * c.raw() - p_raw * s.raw());
  }
}

// Turns R about an oblique axis a, given R a. By Rodrigues' formula the row v becomes
//
//   cos v + sin v x a + (1 - cos) (v . a) a
//
// with a third fewer products than the product with a rotation matrix. |v|, |cos|, |sin a| and |a| are at
// most 1, (1 - cos) |v . a| at most 2: each sum stays within 2^62.
void turn_about_oblique_axis(Rotation& R, const Direction& axis, const Direction& R_axis, Ratio s, Ratio c) {
  const Direction sa = scaled_by(s, axis);
  const Direction along = scaled_by(fixed::kOne - c, R_axis);
  const auto element = [c](Ratio v, Ratio p, Ratio sq, Ratio q, Ratio sp, Ratio along_row, Ratio a) {
    return from_sum_raw(std::int64_t{v.raw()} * c.raw() + std::int64_t{p.raw()} * sq.raw() -
                        std::int64_t{q.raw()} * sp.raw() + std::int64_t{along_row.raw()} * a.raw());
  };
  for (std::size_t i = 0; i < R.rows.size(); ++i) {
    const Direction v = R.rows[i];
    const Ratio d = along.*kComponents[i];
    R.rows[i] = {element(v.x, v.y, sa.z, v.z, sa.y, d, axis.x), element(v.y, v.z, sa.x, v.x, sa.z, d, axis.y),
                 element(v.z, v.x, sa.y, v.y, sa.x, d, axis.z)};
  }
}

}  // namespace

Rotation rotation_about(const Direction& axis, Angle angle) {
  const auto [s, c] = fixed::sin_cos(angle);
  if (const std::size_t i = base_axis(axis); i != kOblique) {
    const Component first = kComponents[kNext[i]];
    const Component second = kComponents[kNext[kNext[i]]];
    const Ratio signed_s = axis.*kComponents[i] < Ratio() ? -s : s;
    Rotation R;
    R.rows[kNext[i]].*first = c;
    R.rows[kNext[i]].*second = -signed_s;
    R.rows[kNext[kNext[i]]].*first = signed_s;
    R.rows[kNext[kNext[i]]].*second = c;
    return R;
  }
  const Ratio versine = fixed::kOne - c;
  const Direction sa = scaled_by(s, axis);
  const Direction va = scaled_by(versine, axis);
  return {{Direction{c, -sa.z, sa.y} + scaled_by(va.x, axis),
           Direction{sa.z, c, -sa.x} + scaled_by(va.y, axis),
           Direction{-sa.y, sa.x, c} + scaled_by(va.z, axis)}};
}

Direction turn_about(Rotation& R, const Direction& axis, Angle angle) {
  const auto [s, c] = fixed::sin_cos(angle);
  const std::size_t i = base_axis(axis);
  if (i == kOblique) {
    const Direction R_axis = R * axis;
    turn_about_oblique_axis(R, axis, R_axis, s, c);
    return R_axis;
  }
  const bool opposite = axis.*kComponents[i] < Ratio();
  turn_about_base_axis(R, i, opposite ? -s : s, c);
  const Direction R_axis = column(R, kComponents[i]);
  return opposite ? -R_axis : R_axis;
}

}  // namespace koboshi::robot
