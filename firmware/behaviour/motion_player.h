#pragma once

#include <cstdint>
#include <span>

#include "firmware/behaviour/motion_source.h"
#include "firmware/behaviour/parameters.h"
#include "firmware/motion/interpreter.h"
#include "firmware/motion/motion_library.h"
#include "firmware/motion/roles.h"

namespace koboshi::behaviour {

// Plays motions of the library, with their corrections.
class MotionPlayer final : public MotionSource {
 public:
  // All must outlive the player.
  MotionPlayer(const robot::RobotModel& model, motion::MotionLibrary& library,
               const RecoveryParameters& parameters)
      : library_(library), parameters_(parameters), interpreter_(model) {}

  // Starts motion `number` of the library, which is open, from the targets in force, one for each joint.
  void start(const motion::Motion& motion, std::uint8_t number, std::span<const fixed::Angle> targets,
             const motion::Inputs& inputs);
  // Starts the motion of a role. Returns false, and nothing changes, on a robot without one.
  [[nodiscard]] bool start(motion::Role role, std::span<const fixed::Angle> targets,
                           const motion::Inputs& inputs);

  void advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
               std::span<fixed::Angle> targets) override;
  void stop() override { interpreter_.stop(); }
  void abort() override { interpreter_.abort(); }
  [[nodiscard]] bool running() const override { return interpreter_.running(); }
  // The declared lean, within the bound of the parameters.
  [[nodiscard]] Plan plan() const override;

  // As at power-on: no motion has been played.
  void forget_number() { number_ = 0; }
  // Returns the number of the motion being played or played last.
  [[nodiscard]] std::uint8_t number() const { return number_; }
  [[nodiscard]] const motion::Interpreter& interpreter() const { return interpreter_; }

 private:
  motion::MotionLibrary& library_;
  const RecoveryParameters& parameters_;
  motion::Interpreter interpreter_;
  std::uint8_t number_ = 0;
};

}  // namespace koboshi::behaviour
