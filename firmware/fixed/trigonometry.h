#pragma once

#include <cstdint>

#include "firmware/fixed/units.h"

// Errors are in LSB of the result's type against the exact function of the exact fixed-point argument, and
// are asserted over the whole domain in tests/unit/firmware/fixed/trigonometry_test.cc.
namespace koboshi::fixed {

struct SineCosine {
  Ratio sine;
  Ratio cosine;
};

// Error at most 1.4 LSB. Odd, even and exact at the quarters: sin(0) = 0, cos(0) = sin(kQuarterTurn) = 1.
[[nodiscard]] Ratio sin(Angle angle);
[[nodiscard]] Ratio cos(Angle angle);
// The same values for less than the price of both.
[[nodiscard]] SineCosine sin_cos(Angle angle);

// The floor of the root.
[[nodiscard]] std::uint32_t integer_square_root(std::uint64_t value);
// The root rounded to nearest; 2^32 does not fit and becomes 2^32 - 1.
[[nodiscard]] std::uint32_t integer_square_root_rounded(std::uint64_t value);

// The angle of the point (x, y) from raw numbers of one format; only their ratio counts. Error at most 1.7
// LSB. -1/2 turn on the negative x axis, 0 at the origin.
[[nodiscard]] Angle atan2_raw(std::int32_t y, std::int32_t x);

// The angle of the point (x, y), counted from x to y.
template <AnyQuantity Q>
[[nodiscard]] Angle atan2(Q y, Q x) {
  return atan2_raw(y.raw(), x.raw());
}

// In [-1/4, 1/4] and [0, 1/2) turn; the argument is clamped to [-1, 1]. acos(-1) is Angle::max(), one LSB
// short of 1/2 turn. Error at most 2 LSB.
[[nodiscard]] Angle asin(Ratio sine);
[[nodiscard]] Angle acos(Ratio cosine);

// The square root in the unit and format of `Result`, rounded to nearest; of a negative number, zero.
// Saturates.
template <AnyQuantity Result, AnyQuantity Q>
[[nodiscard]] Result square_root(Q square) {
  constexpr int kShift = 2 * Result::kFractionBits - Q::kFractionBits;
  static_assert(kShift >= 0 && kShift <= 62, "the formats are too far apart");
  if (square.raw() <= 0) return Result();
  if (std::int64_t{square.raw()} >> (62 - kShift) != 0) return Result::max();
  return Result::from_wide_raw(
      integer_square_root_rounded(static_cast<std::uint64_t>(square.raw()) << kShift));
}

// sqrt(x^2 + y^2), rounded to nearest.
template <AnyQuantity Q>
[[nodiscard]] Q hypotenuse(Q x, Q y) {
  const auto square = [](Q q) { return static_cast<std::uint64_t>(std::int64_t{q.raw()} * q.raw()); };
  return Q::from_wide_raw(integer_square_root_rounded(square(x) + square(y)));
}

// sqrt(x^2 + y^2 + z^2), rounded to nearest.
template <AnyQuantity Q>
[[nodiscard]] Q hypotenuse(Q x, Q y, Q z) {
  const auto square = [](Q q) { return static_cast<std::uint64_t>(std::int64_t{q.raw()} * q.raw()); };
  return Q::from_wide_raw(integer_square_root_rounded(square(x) + square(y) + square(z)));
}

}  // namespace koboshi::fixed
