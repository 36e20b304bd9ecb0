#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "firmware/estimation/robot_state.h"
#include "firmware/motion/instructions.h"
#include "firmware/robot/model.h"

namespace koboshi::motion {

inline constexpr std::size_t kMaxMixes = 16;  // at a time

// The corrections that a motion adds to the targets of its joints from gyro and attitude (kMix).
class Mixer {
 public:
  void clear() { count_ = 0; }
  // Sets the correction of a joint by a source in place of the one before; a gain of zero removes it. Returns
  // false if there are kMaxMixes others.
  [[nodiscard]] bool set(const Mix& mix);
  // Adds the corrections to the targets, by joint, and keeps them within the limits. `lean`: the declared
  // one, from which roll and pitch are measured.
  void add_to(std::span<fixed::Angle> targets, const robot::RobotModel& model,
              const estimation::RobotState& robot, const Lean& lean) const;

 private:
  std::array<Mix, kMaxMixes> mixes_{};
  std::size_t count_ = 0;
};

}  // namespace koboshi::motion
