#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/motion/interpreter.h"

namespace koboshi::behaviour {

// A second motion on joints that the first layer (a motion, the walk or standing still) does not move. It
// replaces the first layer's targets of its joints. After its end they return to the first layer within
// kReturn_us, linearly in time.
class Overlay {
 public:
  // Set by hand (2026-11-23): half a turn then takes 1 turn/s, which the servos follow.
  static constexpr std::int32_t kReturn_us = 500'000;

  // The model must outlive the overlay.
  explicit Overlay(const robot::RobotModel& model) : interpreter_(model) {}

  // Starts a motion from the targets in force, one for each joint.
  void start(const motion::Motion& motion, std::span<const fixed::Angle> targets,
             const motion::Inputs& inputs);
  void stop() { interpreter_.stop(); }
  // Ends the overlay at once, without a return.
  void abort();

  // Returns whether the motion plays.
  [[nodiscard]] bool playing() const { return interpreter_.running(); }
  // Returns the joints that the overlay moves, also while they return; bit i: joint i.
  [[nodiscard]] std::uint32_t joints() const { return joints_; }
  [[nodiscard]] const motion::Interpreter& interpreter() const { return interpreter_; }

  // Puts the first layer's targets of the last cycle in place of the overlay's.
  void uncover(std::span<fixed::Angle> targets) const;
  // Advances the overlay by one cycle and puts its targets in place of those of the first layer, one for each
  // joint.
  void cover(std::uint32_t elapsed_us, const motion::Inputs& inputs, std::span<fixed::Angle> targets);

 private:
  using Angles = std::array<fixed::Angle, robot::kMaxJoints>;

  motion::Interpreter interpreter_;
  std::uint32_t joints_ = 0;
  std::int32_t returned_us_ = 0;  // since the end of the motion
  Angles first_layer_{};          // in the last cycle
  Angles last_{};                 // the targets at the end of the motion
};

}  // namespace koboshi::behaviour
