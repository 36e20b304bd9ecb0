#pragma once

#include <compare>
#include <concepts>
#include <cstdint>
#include <limits>

#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::fixed {

enum class Overflow : std::uint8_t { kWrap, kSaturate };

// Integer types that may scale a quantity: those whose every value fits std::int32_t.
template <typename T>
concept ScalingInteger = std::integral<T> && requires(T value) {
  std::int32_t{value};
};

// A physical quantity in fixed point: raw() * 2^-kFractionBits units, in 32 bits. The tag names the quantity:
// two quantities have no common +, - or comparison and no conversion. On overflow it wraps or saturates, as
// its type says. The default is zero. units.h names the quantities in use.
template <typename TagT, int kFractionBitsV, Overflow kOverflowV>
class Quantity {
 public:
  using Tag = TagT;
  static constexpr int kFractionBits = kFractionBitsV;
  static constexpr Overflow kOverflow = kOverflowV;

  constexpr Quantity() = default;

  [[nodiscard]] static constexpr Quantity from_raw(std::int32_t raw) { return Quantity(raw); }
  // Makes a quantity of a raw value that may not fit: wraps or saturates.
  [[nodiscard]] static constexpr Quantity from_wide_raw(std::int64_t raw) {
    return Quantity(kOverflow == Overflow::kWrap ? wrap<std::int32_t>(raw) : saturate<std::int32_t>(raw));
  }
  [[nodiscard]] static constexpr Quantity min() { return Quantity(std::numeric_limits<std::int32_t>::min()); }
  [[nodiscard]] static constexpr Quantity max() { return Quantity(std::numeric_limits<std::int32_t>::max()); }

  [[nodiscard]] constexpr std::int32_t raw() const { return raw_; }

  constexpr Quantity& operator+=(Quantity other) { return *this = *this + other; }
  constexpr Quantity& operator-=(Quantity other) { return *this = *this - other; }

  friend constexpr Quantity operator+(Quantity a, Quantity b) {
    return Quantity(kOverflow == Overflow::kWrap ? add_wrapped(a.raw_, b.raw_)
                                                 : add_saturated(a.raw_, b.raw_));
  }
  friend constexpr Quantity operator-(Quantity a, Quantity b) {
    return Quantity(kOverflow == Overflow::kWrap ? subtract_wrapped(a.raw_, b.raw_)
                                                 : subtract_saturated(a.raw_, b.raw_));
  }
  friend constexpr Quantity operator-(Quantity a) { return Quantity() - a; }

  template <ScalingInteger Integer>
  friend constexpr Quantity operator*(Quantity a, Integer factor) {
    return from_wide_raw(std::int64_t{a.raw_} * std::int64_t{factor});
  }
  template <ScalingInteger Integer>
  friend constexpr Quantity operator*(Integer factor, Quantity a) {
    return a * factor;
  }
  // Rounds to nearest, ties away from zero.
  template <ScalingInteger Integer>
  friend constexpr Quantity operator/(Quantity a, Integer divisor) {
    return from_wide_raw(divide_rounded(a.raw_, std::int64_t{divisor}));
  }

  // Angles compare as numbers in [-1/2, 1/2) turn.
  friend constexpr auto operator<=>(Quantity, Quantity) = default;

 private:
  explicit constexpr Quantity(std::int32_t raw) : raw_(raw) {}

  std::int32_t raw_ = 0;
};

template <typename T>
concept AnyQuantity = std::same_as<T, Quantity<typename T::Tag, T::kFractionBits, T::kOverflow>>;

// Returns |a|; saturates for every type: the magnitude of an angle of -1/2 turn is one LSB below 1/2 turn.
template <AnyQuantity Q>
[[nodiscard]] constexpr Q abs(Q a) {
  return Q::from_raw(a.raw() < 0 ? subtract_saturated(std::int32_t{0}, a.raw()) : a.raw());
}

// Returns `sum_raw`, a sum of products of A and B in the product's own format, in the format of `Result`;
// |sum_raw| <= 2^62.
template <AnyQuantity Result, AnyQuantity A, AnyQuantity B>
[[nodiscard]] constexpr Result from_product_raw(std::int64_t sum_raw) {
  constexpr int kShift = A::kFractionBits + B::kFractionBits - Result::kFractionBits;
  static_assert(kShift >= 0 && kShift <= 62, "the result has a finer format than its factors together");
  return Result::from_wide_raw(shift_rounded(sum_raw, kShift));
}

// Returns a * b in the unit and format of `Result`, rounded once, to nearest, ties away from zero. The caller
// names the quantity of the product: product<Length>(thigh, cosine).
template <AnyQuantity Result, AnyQuantity A, AnyQuantity B>
[[nodiscard]] constexpr Result product(A a, B b) {
  return from_product_raw<Result, A, B>(std::int64_t{a.raw()} * b.raw());
}

// Returns a0 * b0 + a1 * b1, rounded once, as for a rotated coordinate. Saturates.
template <AnyQuantity Result, AnyQuantity A, AnyQuantity B>
[[nodiscard]] constexpr Result product_sum(A a0, B b0, A a1, B b1) {
  static_assert(Result::kOverflow == Overflow::kSaturate);
  static_assert(A::kFractionBits + B::kFractionBits - Result::kFractionBits <= 31, "2^62 is in the range");
  const std::int64_t first = std::int64_t{a0.raw()} * b0.raw();
  const std::int64_t sum = add_wrapped(first, std::int64_t{a1.raw()} * b1.raw());
  // Beyond 2^62, which neither of them exceeds alone, both have one sign.
  if (sum >> 62 != sum >> 63) [[unlikely]]
    return first < 0 ? Result::min() : Result::max();
  return from_product_raw<Result, A, B>(sum);
}

// Returns a / b in the unit and format of `Result`, rounded once, to nearest, ties away from zero. Division
// by zero gives the extreme value with the sign of a, and 0 / 0 = 0.
template <AnyQuantity Result, AnyQuantity A, AnyQuantity B>
[[nodiscard]] constexpr Result quotient(A a, B b) {
  constexpr int kShift = Result::kFractionBits + B::kFractionBits - A::kFractionBits;
  static_assert(kShift >= -31 && kShift <= 31, "the formats are too far apart");
  const std::int64_t numerator = std::int64_t{a.raw()} * (std::int64_t{1} << (kShift > 0 ? kShift : 0));
  const std::int64_t denominator = std::int64_t{b.raw()} * (std::int64_t{1} << (kShift < 0 ? -kShift : 0));
  if (denominator == 0) return Result::from_raw(saturate<std::int32_t>(divide_rounded(numerator, 0)));
  return Result::from_wide_raw(divide_rounded(numerator, denominator));
}

// Returns a * numerator / denominator, rounded once, to nearest, ties away from zero. Division by zero as in
// `quotient`.
template <AnyQuantity Q>
[[nodiscard]] constexpr Q mul_div(Q a, std::int32_t numerator, std::int32_t denominator) {
  const std::int64_t scaled = std::int64_t{a.raw()} * numerator;
  if (denominator == 0) return Q::from_raw(saturate<std::int32_t>(divide_rounded(scaled, 0)));
  return Q::from_wide_raw(divide_rounded(scaled, denominator));
}

}  // namespace koboshi::fixed
