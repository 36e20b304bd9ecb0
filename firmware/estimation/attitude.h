#pragma once

#include "firmware/fixed/units.h"
#include "firmware/robot/geometry.h"

namespace koboshi::estimation {

// Return the attitude of a trunk by its direction against gravity, as roll about x after pitch about y:
// positive pitch leans forward, positive roll leans to the right. Roll is in [-1/2, 1/2) turn, pitch in
// [-1/4, 1/4] turn.
[[nodiscard]] fixed::Angle roll_of(const robot::Direction& up_B);
[[nodiscard]] fixed::Angle pitch_of(const robot::Direction& up_B);
// Returns by how much the heading of the trunk's x axis, its yaw before pitch and roll, has changed.
// `turn_B_rad`: rotation vector in a cycle, in axes of B, each component within +-0.5 rad; `up_B`: in the
// middle of the cycle. With the trunk pitched by more than 60 degrees, where this axis has hardly a heading,
// it is the turn about gravity. The two differ: a trunk whose roll and pitch oscillate out of phase turns
// about gravity in each period by the area that they enclose, and heads where it did before.
[[nodiscard]] fixed::Angle heading_change(const robot::Vector<fixed::Ratio>& turn_B_rad,
                                          const robot::Direction& up_B);

// Estimates roll and pitch of the trunk B with a complementary filter (as Mahony, Hamel and Pflimlin 2008,
// for the direction against gravity alone, without heading). Its state is the unit vector up_B, which is
// regular in every attitude of a fall. In each cycle, with the rotation vector t of the trunk and the
// specific force f,
//   up_B <- up_B - t x up_B + t x (t x up_B) / 2,   up_B <- up_B + k (f / g - up_B),   up_B <- up_B / |up_B|.
// f points up whenever the trunk does not accelerate; k is the cycle over the filter's time constant.
class AttitudeEstimator {
 public:
  using Acceleration = robot::Vector<fixed::Acceleration>;

  // Selects the time constant with which the specific force corrects the attitude. Moving: 2 s. A residual
  // gyro bias of 0.1 deg/s then tilts the estimate by 0.2 degrees, and an acceleration of 0.25 g that
  // alternates twice a second, as in a walk, by 0.6. Resting: 0.1 s, since the gyro's bias may not be known
  // yet.
  enum class Condition { kMoving, kResting };

  // One 100 Hz cycle. `turn_B_rad`: rotation vector of the trunk since the last cycle, in axes of B, free of
  // the gyro's bias, at most 0.5 rad; the error grows with its cube. `force_B`: specific force in axes of B,
  // used only while its magnitude is within 15 % of g. The first such value sets the attitude at once.
  void update(const robot::Vector<fixed::Ratio>& turn_B_rad, const Acceleration& force_B,
              Condition condition);

  // Returns the unit vector against gravity, in axes of B.
  const robot::Direction& up_B() const { return up_B_; }
  // Return the attitude (roll_of, pitch_of).
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
