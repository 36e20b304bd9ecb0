#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware/motion/motion.h"
#include "simulation/model/robot_model.h"

namespace koboshi::tools {

// A motion whose sensors' conditions and expected attitudes are decided from outside. Each of them is a
// breakpoint, a kFail in place of the step: the interpreter stops there, the caller decides, and plays on
// from a copy of the interpreter. Endless loops run kRounds times.
//
// The interpreter reads the bytes of a step when it comes to it, so that they may change between two calls.
class ForcedMotion {
 public:
  static constexpr std::uint16_t kRounds = 2;

  // `image` was compiled for this robot; else throws std::invalid_argument.
  ForcedMotion(std::span<const std::byte> image, const simulation::NamedModel& robot);
  ForcedMotion(const ForcedMotion&) = delete;  // the views refer to the bytes
  ForcedMotion& operator=(const ForcedMotion&) = delete;

  // The motion with its breakpoints, to be played.
  const motion::Motion& forced() const { return forced_; }
  // The motion as it was compiled.
  const motion::Motion& original() const { return original_; }
  // Whether some loop lasts until a stop command, or a step jumps back.
  bool endless() const { return endless_; }

  // Sets all breakpoints but that of the step `except`.
  void arm(std::uint16_t except);
  [[nodiscard]] bool is_armed(std::uint16_t step) const { return armed_[step]; }
  // Removes the breakpoint of a condition, which then has this outcome.
  void decide(std::uint16_t step, bool holds);
  // Removes the breakpoint of an expected attitude, which is then met.
  void satisfy(std::uint16_t step);

 private:
  std::span<std::byte> bytes_of(std::size_t step, std::size_t count = 1);
  void write(std::size_t step, const motion::Step& value);
  void find_tainted_variables();
  [[nodiscard]] bool is_tainted(std::uint16_t source) const;
  [[nodiscard]] bool reads_sensors(std::size_t condition) const;

  std::vector<std::byte> original_bytes_;
  std::vector<std::byte> bytes_;
  motion::Motion original_;
  motion::Motion forced_;
  std::uint32_t tainted_ = 0;               // variables whose values depend on sensors
  std::vector<std::uint16_t> breakpoints_;  // steps
  std::vector<bool> armed_;                 // by step
  bool endless_ = false;
};

}  // namespace koboshi::tools
