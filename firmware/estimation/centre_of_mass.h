#pragma once

#include <optional>

#include "firmware/estimation/level_axes.h"
#include "firmware/estimation/posture.h"
#include "firmware/robot/geometry.h"

namespace koboshi::estimation {

// The motion of the centre of mass (CoM) relative to a foot that stands. Frame: the origin of that foot's
// sole, x along the sole's heading, y to the left, z against gravity, by the attitude.
struct CentreOfMassMotion {
  template <fixed::AnyQuantity Q>
  struct Level {
    Q x;
    Q y;
  };

  bool valid = false;  // false while the sole stands on edge; the values are then the last ones
  hal::Side sole = hal::Side::kLeft;
  Level<fixed::Length> position;
  fixed::Length height;
  Level<fixed::Speed> velocity;
  // The divergent component of motion x + v sqrt(z / g) (Englsberger, Ott and Albu-Schaeffer, T-RO 2015), of
  // a CoM at this height; z within 0.05 to 1 m.
  Level<fixed::Length> dcm;
};

// Observes position and velocity of the CoM. The specific force f of the inertial unit, which is the CoM's
// acceleration but for the turning of the trunk, predicts them; the CoM by the joint angles, levelled by the
// attitude, corrects them. Along each level axis, with the cycle h,
//
//   x <- x + v h + f h^2 / 2,   v <- v + f h,   e = x_joints - x,   x <- x + 0.3 e,   v <- v + 5 / s e.
//
// A Luenberger observer of a double integrator with poles at 0.85 +- 0.16 j, 60 ms: slower ones keep more of
// the accelerometer's bias in the velocity (50 mg would be 0.1 m/s at a second), faster ones more of the
// encoders' steps. The gains are those of the prototype of the walk, 2026-11; docs/experiment/estimation.md
// has what is left.
class CentreOfMassObserver {
 public:
  // Takes a cycle of 10 ms. `up_B`: unit vector against gravity; `force_B`: specific force. `axes`: those of
  // `sole`, the foot that stands. Where it is another one than in the last cycle, the motion goes over into
  // that foot's frame by the joint angles.
  const CentreOfMassMotion& update(const Posture& posture, const std::optional<LevelAxes>& axes,
                                   const robot::Direction& up_B,
                                   const robot::Vector<fixed::Acceleration>& force_B, hal::Side sole);
  const CentreOfMassMotion& motion() const { return motion_; }

 private:
  CentreOfMassMotion motion_;
  fixed::Length height_of_root_;
  fixed::Ratio time_constant_s_;
};

}  // namespace koboshi::estimation
