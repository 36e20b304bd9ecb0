#pragma once

#include "firmware/fixed/units.h"
#include "firmware/robot/geometry.h"

namespace koboshi::estimation {

// Roll and pitch of the trunk: a complementary filter. It keeps the direction that is up, as a unit vector in
// axes of B, which has no singular attitude whatever way the robot falls; carries it along with the gyro; and
// draws it slowly to the specific force, which points up whenever the trunk does not accelerate.
class AttitudeEstimator {
 public:
  using Acceleration = robot::Vector<fixed::Acceleration>;

  // How far the specific force is believed. A robot that moves: with a time constant of 2 s, so that 0.1
  // deg/s that are left of the gyro's bias make 0.2 degrees, and a walk's acceleration of 0.25 g that
  // alternates twice a second 0.6. A robot that rests: of 0.1 s, for its gyro may not be calibrated yet.
  enum class Condition { kMoving, kResting };

  // One 100 Hz cycle. `turn_B_rad` is the rotation vector of the trunk since the last one, in axes of B, free
  // of the gyro's bias; at most 0.5 rad, beyond that errors grow with its cube. `force_B` is the specific
  // force; it counts only while it is within 15 % of g. The first that does sets the attitude at once.
  void update(const robot::Vector<fixed::Ratio>& turn_B_rad, const Acceleration& force_B,
              Condition condition);

  // Unit vector against gravity, in axes of B.
  const robot::Direction& up_B() const { return up_B_; }
  // Roll about x, then pitch about y; a trunk that leans forward has positive pitch, one that leans to the
  // right positive roll. Roll in [-1/2, 1/2) turn, pitch in [-1/4, 1/4].
  fixed::Angle roll() const { return roll_; }
  fixed::Angle pitch() const { return pitch_; }

 private:
  void turn(const robot::Vector<fixed::Ratio>& turn_B_rad);
  void correct(const Acceleration& force_B, Condition condition);
  void normalise();

  robot::Direction up_B_ = robot::kAxisZ;
  fixed::Angle roll_;
  fixed::Angle pitch_;
  bool known_ = false;
};

}  // namespace koboshi::estimation
