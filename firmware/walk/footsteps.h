#pragma once

#include <cstdint>

#include "firmware/walk/plane.h"
#include "hal/port/side.h"

namespace koboshi::walk {

// Where the robot is told to go: by how much a step takes it there.
struct Stride {
  Point distance;
  fixed::Angle turn;
};

[[nodiscard]] constexpr hal::Side other(hal::Side side) {
  return side == hal::Side::kLeft ? hal::Side::kRight : hal::Side::kLeft;
}

// The steps of a walk that goes on as it is: both feet in turn, the one that the robot goes or turns to opens
// by twice the way, and the other closes. Of the pendulum on it the one motion that repeats itself every two
// steps.
class Footsteps {
 public:
  // `width` between the places of the ZMP under both feet; `growth` of the divergent motion in a step; `lag`
  // by which the ZMP comes after the step (Pendulum::lag).
  Footsteps(fixed::Length width, fixed::Gain growth, fixed::Ratio lag);

  // From the ZMP under the foot that stands to that under the foot that swings, and the turn of its sole.
  [[nodiscard]] Foothold step(hal::Side swing, const Stride& stride) const;

  // Where the divergent part has to be when a step onto `stance` begins, from the ZMP under it, after a step
  // as the last one of this stride was.
  [[nodiscard]] Point offset(hal::Side stance, const Stride& stride) const;
  // The same for a ZMP that would come at once. From there on the divergent part moves as it should after any
  // last step: one that ends `end` from the ZMP has to go to end * widening() - offset_at_once().
  [[nodiscard]] Point offset_at_once(hal::Side stance, const Stride& stride) const;
  [[nodiscard]] fixed::Gain widening() const { return widening_; }

 private:
  fixed::Length width_;
  fixed::Gain growth_;
  fixed::Ratio lag_;
  fixed::Ratio share_;    // 1 / (growth^2 - 1), which is below 2 for steps of 30 ms and more
  fixed::Gain widening_;  // 1 / (1 - lag)
};

}  // namespace koboshi::walk
