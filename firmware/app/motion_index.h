#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/motion/motion.h"
#include "firmware/recovery/motions.h"

namespace koboshi::app {

// Which motions are valid, and which of them the robot falls and gets up by.
class MotionIndex {
 public:
  // `valid`: bit n is set when motion n is there. Outlives the index.
  explicit MotionIndex(std::uint32_t& valid) : valid_(valid) { by_role_.fill(kNone); }

  // A motion that is new under its number. One of two with the same name is the one that came last.
  void add(std::uint16_t number, const motion::Motion& motion);
  std::optional<std::uint16_t> number_of(recovery::Role role) const;

 private:
  static constexpr std::uint8_t kNone = 0xFF;

  std::uint32_t& valid_;
  std::array<std::uint8_t, recovery::kMotionNames.size()> by_role_;
};

}  // namespace koboshi::app
