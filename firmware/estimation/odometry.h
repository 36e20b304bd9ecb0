#pragma once

#include "firmware/estimation/level_axes.h"
#include "firmware/estimation/posture.h"
#include "firmware/robot/geometry.h"

namespace koboshi::estimation {

// Where the trunk is and where it heads, since power-on or the last reset: x along the heading that the robot
// had then, y to the left.
struct Odometer {
  fixed::Length x;
  fixed::Length y;
  fixed::Angle heading;  // counter-clockwise
};

// Adds up the way of the trunk. The foot that stands does not move, so the trunk moves as the joints move it
// about that foot, in the plane by the attitude. The heading is the gyro's (heading_change): a foot that
// bears twists on the floor, by up to a third of each turn. While the robot rests neither changes, so that
// the gyro's remaining bias does not turn a robot that stands.
//
// Errors: what the feet slide, and the gyro's scale, 3 % of each turn (docs/experiment/estimation.md).
class Odometry {
 public:
  // Takes a cycle of 10 ms. `turn`: the change of the trunk's heading in it, by the gyro without a filter,
  // whose delay would turn a swaying trunk's motion into a drift of 0.2 deg/s. `axes`: those of `foot`, which
  // stands; `rests`: the robot stands still.
  const Odometer& update(const Posture& posture, const std::optional<LevelAxes>& axes,
                         const robot::Direction& up_B, fixed::Angle turn, hal::Side foot, bool rests);
  const Odometer& odometer() const { return odometer_; }

 private:
  // The trunk's origin from a sole, along its level axes, and the heading of the sole from that of the trunk.
  struct FromSole {
    bool valid = false;
    fixed::Length x;
    fixed::Length y;
    fixed::Angle yaw;
  };

  struct Way {
    fixed::Length x;
    fixed::Length y;
  };

  // `heading`: of the trunk.
  [[nodiscard]] static Way in_world(const FromSole& from, fixed::Angle heading);
  [[nodiscard]] static FromSole from_sole(const robot::Pose& X_BSole, const std::optional<LevelAxes>& axes,
                                          const robot::Direction& up_B);

  FromSole last_;  // in the last cycle, from that foot
  hal::Side foot_ = hal::Side::kLeft;
  Odometer odometer_;
};

}  // namespace koboshi::estimation
