#pragma once

#include <cstdint>
#include <span>

#include "firmware/fixed/units.h"
#include "firmware/robot/model.h"
#include "hal/port/side.h"

namespace koboshi::walk {

// The arms of a walk: they swing with the feet, and turn against an error of the plan ahead. Arms without a
// pitch joint of the shoulder stay as they are.
//
// Arms that turn with a robot that topples take up its angular momentum L (the pendulum with a flywheel of
// Pratt, Carff, Drakunov and Goswami, "Capture point: a step toward humanoid push recovery", Humanoids 2006):
//
//   m z x'' = m g (x - p) - L'
//
// Arms that hang turn back when it topples forward. What they took comes back when they stop; by then a step
// has been taken.
class Arms {
 public:
  explicit Arms(const robot::RobotModel& model);

  // Brings the arms back to where they swing from, at once.
  void reset() { back_ = fixed::Angle(); }
  // Turns the arms by one cycle against `dcm_error`, the measured DCM less the planned one, forward; towards
  // `reaction` rad/m of it, at most 60 degrees.
  void react(fixed::Length dcm_error, fixed::Gain reaction);
  // Writes the targets of the shoulders' pitch: those of `standing`, turned by the reaction and by `swing`
  // rad/m of `left_forward`, by which the left foot is ahead of the right one.
  void pose(fixed::Length left_forward, fixed::Ratio swing, std::span<const fixed::Angle> standing,
            std::span<fixed::Angle> targets) const;

 private:
  // The pitch joint of a shoulder: its arm swings with the foot of the other side.
  struct Shoulder {
    robot::JointIndex joint;
    std::int8_t sign = 0;  // of the joint's axis; 0 on a robot without the joint
  };

  hal::BySide<Shoulder> shoulders_{};
  fixed::Angle back_;  // the reaction; positive back
};

}  // namespace koboshi::walk
