#include "firmware/estimation/odometry.h"

#include "firmware/fixed/trigonometry.h"

namespace koboshi::estimation {

using fixed::Length;

// The heading of the trunk is its x axis in the plane; up x x_B is the level axis to its left.
Odometry::FromSole Odometry::from_sole(const robot::Pose& X_BSole, const std::optional<LevelAxes>& axes,
                                       const robot::Direction& up_B) {
  if (!axes) return {};
  const robot::Position p_SoleB = -X_BSole.p;
  const robot::Direction left_of_trunk = cross(up_B, robot::kAxisX);
  return {.valid = true,
          .x = dot(axes->forward, p_SoleB),
          .y = dot(axes->left, p_SoleB),
          .yaw = fixed::atan2(dot(axes->forward, left_of_trunk), dot(axes->left, left_of_trunk))};
}

Odometry::Way Odometry::in_world(const FromSole& from, fixed::Angle heading) {
  const auto [sine, cosine] = fixed::sin_cos(heading + from.yaw);
  return {.x = fixed::product_sum<Length>(from.x, cosine, -from.y, sine),
          .y = fixed::product_sum<Length>(from.x, sine, from.y, cosine)};
}

// When another foot comes to stand, both do: the way of that cycle is measured from the one that stood
// before.
const Odometer& Odometry::update(const Posture& posture, const std::optional<LevelAxes>& axes,
                                 const robot::Direction& up_B, fixed::Angle turn, hal::Side foot,
                                 bool rests) {
  const fixed::Angle heading = odometer_.heading;
  if (!rests) odometer_.heading += turn;
  const robot::Pose& X_BLast = posture.X_BSole[foot_];
  const FromSole from_foot = from_sole(posture.X_BSole[foot], axes, up_B);
  const FromSole from_last =
      foot == foot_ ? from_foot : from_sole(X_BLast, level_axes(X_BLast.R, up_B), up_B);
  if (!rests && last_.valid && from_last.valid) {
    // Each in the world's axes by the foot's heading of its own moment: a foot that twists does not move.
    const auto [x, y] = in_world(from_last, odometer_.heading);
    const auto [last_x, last_y] = in_world(last_, heading);
    odometer_.x += x - last_x;
    odometer_.y += y - last_y;
  }
  last_ = from_foot;
  foot_ = foot;
  return odometer_;
}

}  // namespace koboshi::estimation
