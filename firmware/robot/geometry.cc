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

Rotation rotation_about(const Direction& axis, Angle angle) {
  const auto [s, c] = fixed::sin_cos(angle);
  const Ratio versine = fixed::kOne - c;
  const auto scaled = [](Ratio factor, const Direction& a) -> Direction {
    return {product<Ratio>(factor, a.x), product<Ratio>(factor, a.y), product<Ratio>(factor, a.z)};
  };
  const Direction sa = scaled(s, axis);
  const Direction va = scaled(versine, axis);
  return {{Direction{c, -sa.z, sa.y} + scaled(va.x, axis), Direction{sa.z, c, -sa.x} + scaled(va.y, axis),
           Direction{-sa.y, sa.x, c} + scaled(va.z, axis)}};
}

}  // namespace koboshi::robot
