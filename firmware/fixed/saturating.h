#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

namespace koboshi::fixed {

// The value of `To` nearest to `value`.
template <std::integral To, std::integral From>
[[nodiscard]] constexpr To saturate(From value) {
  const To kept = static_cast<To>(value);
  if (std::cmp_equal(kept, value)) [[likely]]
    return kept;  // one comparison, for nearly all values
  return value < From{} ? std::numeric_limits<To>::min() : std::numeric_limits<To>::max();
}

// The value of `To` that is congruent to `value` modulo 2 to the width of `To`: the low bits.
template <std::integral To, std::integral From>
[[nodiscard]] constexpr To wrap(From value) {
  return static_cast<To>(value);
}

// a + b and a - b, or the nearest value of T. A Cortex-M4 has an instruction for 32 bits (ACLE,
// section 8.4.2), which its compiler does not find by itself; without it the image is 6 KB larger.
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

// a + b and a - b modulo 2 to the width of T. Signed overflow is what they are for, so it is no undefined
// behaviour here.
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

// Counts events and stays at its maximum instead of starting again from zero: a reader may trust a small
// number.
template <std::unsigned_integral T>
class SaturatingCounter {
 public:
  constexpr void increment() { add(1); }
  constexpr void add(T events) { value_ = add_saturated(value_, events); }
  [[nodiscard]] constexpr T value() const { return value_; }

 private:
  T value_ = 0;
};

}  // namespace koboshi::fixed
