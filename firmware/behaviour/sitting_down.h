#pragma once

#include <cstdint>
#include <span>

#include "firmware/behaviour/motion_player.h"
#include "firmware/behaviour/motion_source.h"

namespace koboshi::behaviour {

// Sits down, from a motion, a walk or standing: ends what the robot does in its orderly way, a walk by its
// own steps, then plays the motion of Role::kSit. The robot stands between the two.
class SittingDown final : public MotionSource {
 public:
  // The player must outlive this object; it plays the motion.
  explicit SittingDown(MotionPlayer& player) : player_(player) {}

  // Starts with the end of `last`, the source of the present state; null: the robot stands.
  void begin(MotionSource* last);

  void advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
               std::span<fixed::Angle> targets) override;
  // Sitting down always goes to its end.
  void stop() override {}
  void abort() override;
  [[nodiscard]] bool running() const override { return phase_ != Phase::kIdle; }
  [[nodiscard]] Plan plan() const override;
  // Returns whether the robot sits: the motion has ended and has not failed.
  [[nodiscard]] bool done() const { return done_; }

 private:
  enum class Phase : std::uint8_t {
    kIdle,
    kEnding,   // `last_` ends
    kSitting,  // the motion plays
  };

  MotionPlayer& player_;
  MotionSource* last_ = nullptr;  // null once it has ended
  Phase phase_ = Phase::kIdle;
  bool done_ = false;
};

}  // namespace koboshi::behaviour
