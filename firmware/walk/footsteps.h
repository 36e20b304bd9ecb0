#pragma once

#include <cstdint>

#include "firmware/walk/plane.h"
#include "hal/port/side.h"

namespace koboshi::walk {

// The commanded velocity times the duration of a step: distance and turn of the robot in one step.
struct Stride {
  Point distance;
  fixed::Angle turn;
};

using hal::other;

// The periodic gait at a constant stride: its footholds, and the motion of the DCM on them that repeats
// itself every two steps. In a lateral step the foot on the side that the robot moves to opens by twice the
// stride, and the other foot closes. In a turn every foot turns by the stride's turn.
class Footsteps {
 public:
  // `width`: distance of the ZMPs under both feet. `growth`: of the DCM in a step (Pendulum::growth). `lag`:
  // of the ZMP in double support (Pendulum::lag).
  Footsteps(fixed::Length width, fixed::Gain growth, fixed::Ratio lag);

  // Nominal step: from the ZMP under the support foot to the ZMP under the swing foot where it lands, and the
  // turn of the swing foot's sole.
  [[nodiscard]] Foothold step(hal::Side swing, const Stride& stride) const;

  // Offset of the DCM from the ZMP under `stance` when a step onto that foot begins, in the periodic gait.
  // Derivation in footsteps.cc.
  [[nodiscard]] Point offset(hal::Side stance, const Stride& stride) const;
  // The same offset for a ZMP that steps at once, without double support. It also serves after a last step of
  // any length: a DCM that ends `end` away from the old ZMP needs the new ZMP at end * widening() -
  // offset_at_once().
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
