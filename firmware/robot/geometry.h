#pragma once

#include <array>
#include <cstddef>

#include "firmware/fixed/units.h"

namespace koboshi::robot {

// A vector of one quantity. Its axes are named in its variable (monogram notation, docs/design/frames.md):
// p_BH_B points from B to H, in axes of B.
template <fixed::AnyQuantity Q>
struct Vector {
  Q x;
  Q y;
  Q z;

  friend constexpr Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vector operator-(Vector a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr bool operator==(const Vector&, const Vector&) = default;
};

using Position = Vector<fixed::Length>;
using Direction = Vector<fixed::Ratio>;

inline constexpr Direction kAxisX{.x = fixed::kOne, .y = {}, .z = {}};
inline constexpr Direction kAxisY{.x = {}, .y = fixed::kOne, .z = {}};
inline constexpr Direction kAxisZ{.x = {}, .y = {}, .z = fixed::kOne};

// A rotation matrix. R_AB converts coordinates in axes of B to coordinates in axes of A. Each product rounds
// its elements by half an LSB of Ratio, 5e-10; the rotations of a kinematic chain stay orthonormal to about
// 1e-8.
struct Rotation {
  std::array<Direction, 3> rows{kAxisX, kAxisY, kAxisZ};

  friend constexpr bool operator==(const Rotation&, const Rotation&) = default;
};

// A rigid transform. X_AB is the pose of frame B in A: R_AB and p_AB_A.
struct Pose {
  Rotation R;
  Position p;
};

// Returns a . v, rounded once; saturates. Requires |a| <= 1: by the Cauchy-Schwarz inequality the sum then
// stays below 2^62 for every v.
template <fixed::AnyQuantity Q>
[[nodiscard]] constexpr Q dot(const Direction& a, const Vector<Q>& v) {
  const std::int64_t sum_raw = std::int64_t{a.x.raw()} * v.x.raw() + std::int64_t{a.y.raw()} * v.y.raw() +
                               std::int64_t{a.z.raw()} * v.z.raw();
  return fixed::from_product_raw<Q, fixed::Ratio, Q>(sum_raw);
}

// Returns a x b, each element rounded once. Requires |a| < 2 and |b| <= 1.
[[nodiscard]] constexpr Direction cross(const Direction& a, const Direction& b) {
  const auto element = [](fixed::Ratio p, fixed::Ratio q, fixed::Ratio r, fixed::Ratio s) {
    return fixed::from_product_raw<fixed::Ratio, fixed::Ratio, fixed::Ratio>(std::int64_t{p.raw()} * q.raw() -
                                                                             std::int64_t{r.raw()} * s.raw());
  };
  return {element(a.y, b.z, a.z, b.y), element(a.z, b.x, a.x, b.z), element(a.x, b.y, a.y, b.x)};
}

template <fixed::AnyQuantity Q>
[[nodiscard]] constexpr Vector<Q> operator*(const Rotation& R, const Vector<Q>& v) {
  return {dot(R.rows[0], v), dot(R.rows[1], v), dot(R.rows[2], v)};
}

// Returns an axis of the turned frame: column(R_AB, &Direction::z) is the z axis of B in A.
[[nodiscard]] constexpr Direction column(const Rotation& R, fixed::Ratio Direction::*axis) {
  return {R.rows[0].*axis, R.rows[1].*axis, R.rows[2].*axis};
}

[[nodiscard]] constexpr Rotation transpose(const Rotation& R) {
  const auto& [a, b, c] = R.rows;
  return {{Direction{a.x, b.x, c.x}, Direction{a.y, b.y, c.y}, Direction{a.z, b.z, c.z}}};
}

[[nodiscard]] Rotation operator*(const Rotation& R_AB, const Rotation& R_BC);
[[nodiscard]] Pose operator*(const Pose& X_AB, const Pose& X_BC);

// Returns the rotation by `angle` about the unit vector `axis`, by the right-hand rule (Rodrigues' formula):
// cos I + sin [a]x + (1 - cos) a a^T.
[[nodiscard]] Rotation rotation_about(const Direction& axis, fixed::Angle angle);

// Turns the frame of R about its own axis: R becomes R rotation_about(axis, angle). Returns the axis in the
// outer frame, which the turn keeps. About an axis of the base the result is that product bit for bit, with
// a third of its products; about any other, it is that product with fewer roundings.
Direction turn_about(Rotation& R, const Direction& axis, fixed::Angle angle);

}  // namespace koboshi::robot
