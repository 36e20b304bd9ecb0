#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <utility>

namespace koboshi::fixed {

// The value of `To` nearest to `value`.
template <std::integral To, std::integral From>
[[nodiscard]] constexpr To saturate(From value) {
  if (std::cmp_less(value, std::numeric_limits<To>::min())) return std::numeric_limits<To>::min();
  if (std::cmp_greater(value, std::numeric_limits<To>::max())) return std::numeric_limits<To>::max();
  return static_cast<To>(value);
}

// The value of `To` that is congruent to `value` modulo 2 to the width of `To`: the low bits.
template <std::integral To, std::integral From>
[[nodiscard]] constexpr To wrap(From value) {
  return static_cast<To>(value);
}

template <std::integral T>
[[nodiscard]] constexpr T add_saturated(T a, T b) {
  T sum{};
  if (!__builtin_add_overflow(a, b, &sum)) return sum;
  return b < T{} ? std::numeric_limits<T>::min() : std::numeric_limits<T>::max();
}

template <std::integral T>
[[nodiscard]] constexpr T subtract_saturated(T a, T b) {
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
