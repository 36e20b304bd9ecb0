#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

namespace koboshi::fixed {

// Returns the value of `To` nearest to `value`.
template <std::integral To, std::integral From>
[[nodiscard]] constexpr To saturate(From value) {
  const To kept = static_cast<To>(value);
  if (std::cmp_equal(kept, value)) [[likely]]
    return kept;  // the common case, by one comparison
  return value < From{} ? std::numeric_limits<To>::min() : std::numeric_limits<To>::max();
}

// Returns the low bits of `value`: the value of `To` congruent to it modulo 2 to the width of `To`.
template <std::integral To, std::integral From>
[[nodiscard]] constexpr To wrap(From value) {
  return static_cast<To>(value);
}

// Return a + b and a - b, or the nearest value of T. For 32 bits a Cortex-M4 has instructions (ACLE, section
// 8.4.2) that GCC 12 does not generate by itself; without them the image is 6 KB larger (decision 11).
template <std::integral T>
[[nodiscard]] constexpr T add_saturated(T a, T b) {
#ifdef __ARM_FEATURE_DSP
  if constexpr (sizeof(T) == sizeof(int) && std::signed_integral<T>) {
    if (!std::is_constant_evaluated())
      return static_cast<T>(__builtin_arm_qadd(static_cast<int>(a), static_cast<int>(b)));
  }
#endif
  T sum{};
  if (!__builtin_add_overflow(a, b, &sum)) return sum;
  return b < T{} ? std::numeric_limits<T>::min() : std::numeric_limits<T>::max();
}

template <std::integral T>
[[nodiscard]] constexpr T subtract_saturated(T a, T b) {
#ifdef __ARM_FEATURE_DSP
  if constexpr (sizeof(T) == sizeof(int) && std::signed_integral<T>) {
    if (!std::is_constant_evaluated())
      return static_cast<T>(__builtin_arm_qsub(static_cast<int>(a), static_cast<int>(b)));
  }
#endif
  T difference{};
  if (!__builtin_sub_overflow(a, b, &difference)) return difference;
  return std::signed_integral<T> && b < T{} ? std::numeric_limits<T>::max() : std::numeric_limits<T>::min();
}

// Return a + b and a - b modulo 2 to the width of T, also for signed types, without undefined behaviour.
template <std::integral T>
[[nodiscard]] constexpr T add_wrapped(T a, T b) {
  T sum{};
  static_cast<void>(__builtin_add_overflow(a, b, &sum));
  return sum;
}

template <std::integral T>
[[nodiscard]] constexpr T subtract_wrapped(T a, T b) {
  T difference{};
  static_cast<void>(__builtin_sub_overflow(a, b, &difference));
  return difference;
}

}  // namespace koboshi::fixed
