#pragma once

#include <cstdint>

namespace koboshi::fixed {

// Counts the consecutive calls in which a condition holds, so that a single sample decides nothing. The
// owner gives the number that counts as certain with each call, since parameters may change it.
class Debounce {
 public:
  // One sample. Returns true from the `required`-th consecutive sample on for which `holds` is true; with
  // 1 at the first. A `required` of zero counts as 1.
  constexpr bool update(bool holds, std::uint16_t required) noexcept {
    count(holds);
    return reached(required);
  }
  // One sample, without asking.
  constexpr void count(bool holds) noexcept {
    if (!holds) {
      count_ = 0;
    } else if (count_ < kMaxCount) {
      ++count_;
    }
  }
  // Whether the last `required` samples held.
  [[nodiscard]] constexpr bool reached(std::uint16_t required) const noexcept {
    return count_ != 0 && count_ >= required;
  }
  // Forgets all samples.
  constexpr void reset() noexcept { count_ = 0; }

 private:
  static constexpr std::uint16_t kMaxCount = 0xFFFF;  // stays there: more is not told apart

  std::uint16_t count_ = 0;
};

}  // namespace koboshi::fixed
