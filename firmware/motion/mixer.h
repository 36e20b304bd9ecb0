#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/estimation/robot_state.h"
#include "firmware/motion/instructions.h"
#include "firmware/robot/model.h"

namespace koboshi::motion {

inline constexpr std::size_t kMaxMixes = 16;  // at a time

// The corrections that a motion adds to the targets of its joints from gyro and attitude (kMix). One that is
// removed does not drop at once: its last value fades linearly within kFade_us.
class Mixer {
 public:
  // Set by hand (2026-11-23): the largest correction, 15 degrees, then turns a joint by 75 deg/s; five
  // corrections of one joint by 375 deg/s.
  static constexpr std::uint32_t kFade_us = 200'000;

  // Removes all corrections, those that fade too.
  void reset();
  // Removes all corrections: they fade.
  void clear() {
    while (count_ > 0) remove(count_ - 1);
  }
  // Sets the correction of a joint by a source in place of the one before; a gain of zero removes it. Returns
  // false if there are kMaxMixes others.
  [[nodiscard]] bool set(const Mix& mix);
  // Lets corrections that were removed fade for so long.
  void pass(std::uint32_t elapsed_us) {
    if (fading_ != 0) fade(elapsed_us);
  }
  // Returns whether a correction that was removed still fades.
  [[nodiscard]] bool fading() const { return fading_ != 0; }
  // Returns the corrections in force, without those that fade.
  [[nodiscard]] std::span<const Mix> mixes() const { return std::span(mixes_).first(count_); }
  // Adds the corrections to the targets, by joint, and keeps them within the limits. `lean`: the declared
  // one, from which roll and pitch are measured.
  void add_to(std::span<fixed::Angle> targets, const robot::RobotModel& model,
              const estimation::RobotState& robot, const Lean& lean) {
    if (count_ != 0 || fading_ != 0) add_all(targets, model, robot, lean);
  }

 private:
  // The rest of removed corrections: `from_raw`, 2^-32 turn, times left_us / kFade_us.
  struct Fade {
    std::int32_t from_raw = 0;
    std::uint32_t left_us = 0;

    [[nodiscard]] std::int32_t value_raw() const {
      return static_cast<std::int32_t>(std::int64_t{from_raw} * left_us / kFade_us);
    }
  };

  void remove(std::size_t place);
  void fade(std::uint32_t elapsed_us);
  void add_all(std::span<fixed::Angle> targets, const robot::RobotModel& model,
               const estimation::RobotState& robot, const Lean& lean);

  std::array<Mix, kMaxMixes> mixes_{};
  std::array<std::int32_t, kMaxMixes> last_raw_{};  // the last value of each
  std::array<Fade, robot::kMaxJoints> fades_{};
  std::uint32_t fading_ = 0;  // joints that `fades_` still corrects; bit i: joint i
  std::size_t count_ = 0;
};

}  // namespace koboshi::motion
