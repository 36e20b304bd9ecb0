#pragma once

#include <cstdint>
#include <type_traits>

// Scaling of the integers of a network. Each function gives the same bits on every core.
namespace koboshi::policy {

// Returns the value nearest to `value` that an int16 holds.
[[nodiscard]] constexpr std::int32_t saturate16(std::int32_t value) {
#ifdef __ARM_FEATURE_DSP
  if (!std::is_constant_evaluated()) return static_cast<std::int32_t>(__builtin_arm_ssat(value, 16));
#endif
  return value < -32768 ? -32768 : value > 32767 ? 32767 : value;
}

// Returns value * multiplier / 2^32, rounded to nearest, ties up, as the instruction SMMULR does it.
[[nodiscard]] constexpr std::int32_t multiply_high(std::int32_t value, std::int32_t multiplier) {
#ifdef __ARM_FEATURE_DSP
  if (!std::is_constant_evaluated()) {
    std::int32_t high = 0;
    asm("smmulr %0, %1, %2" : "=r"(high) : "r"(value), "r"(multiplier));  // GCC 12 does not find it
    return high;
  }
#endif
  const std::int64_t product = std::int64_t{value} * multiplier;
  return static_cast<std::int32_t>((product + (std::int64_t{1} << 31)) >> 32);
}

// Returns value * multiplier / 2^32, rounded to nearest and saturated to an int16.
[[nodiscard]] constexpr std::int32_t rescale(std::int32_t value, std::int32_t multiplier) {
  return saturate16(multiply_high(value, multiplier));
}

}  // namespace koboshi::policy
