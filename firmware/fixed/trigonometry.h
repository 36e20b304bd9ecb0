#pragma once

#include <cstdint>

#include "firmware/fixed/units.h"

// Errors are in LSB of the result's type, relative to the exact function of the fixed-point argument.
// tests/unit/firmware/fixed/trigonometry_test.cc asserts them over the whole domain.
namespace koboshi::fixed {

struct SineCosine {
  Ratio sine;
  Ratio cosine;
};

// Return sine and cosine; error at most 1.4 LSB. They are exactly odd and even, and exact at multiples of a
// quarter turn.
[[nodiscard]] Ratio sin(Angle angle);
[[nodiscard]] Ratio cos(Angle angle);
// Returns both, with the same values, at less than the cost of two calls.
[[nodiscard]] SineCosine sin_cos(Angle angle);

// Returns the square root, rounded down.
[[nodiscard]] std::uint32_t integer_square_root(std::uint64_t value);
// Returns the square root, rounded to nearest; 2^32 does not fit and becomes 2^32 - 1.
[[nodiscard]] std::uint32_t integer_square_root_rounded(std::uint64_t value);

// 1 / sqrt(value) as mantissa * 2^-shift, with a mantissa from 2^30 to 2^31, or 2^-23 beyond.
struct InverseRoot {
  std::uint32_t mantissa;
  int shift;
};

// Returns the inverse of the square root of a value above zero, to 2^-23 of itself: half of the instructions
// of a root and a division.
[[nodiscard]] InverseRoot inverse_square_root(std::uint64_t value);

// Returns the angle of the point (x, y) from the x axis, given as raw numbers of one format. Error at most
// 1.7 LSB. It is -1/2 turn on the negative x axis and 0 at the origin.
[[nodiscard]] Angle atan2_raw(std::int32_t y, std::int32_t x);

// Returns the angle of the point (x, y), from the x axis towards the y axis.
template <AnyQuantity Q>
[[nodiscard]] Angle atan2(Q y, Q x) {
  return atan2_raw(y.raw(), x.raw());
}

// Return angles in [-1/4, 1/4] and [0, 1/2) turn; error at most 2 LSB. The argument is clamped to [-1, 1].
// acos(-1) is Angle::max(), one LSB below 1/2 turn.
[[nodiscard]] Angle asin(Ratio sine);
[[nodiscard]] Angle acos(Ratio cosine);

// Returns the square root in the unit and format of `Result`, rounded to nearest; zero for a negative number.
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

// Returns sqrt(x^2 + y^2), rounded to nearest.
template <AnyQuantity Q>
[[nodiscard]] Q hypotenuse(Q x, Q y) {
  const auto square = [](Q q) { return static_cast<std::uint64_t>(std::int64_t{q.raw()} * q.raw()); };
  return Q::from_wide_raw(integer_square_root_rounded(square(x) + square(y)));
}

// Returns sqrt(x^2 + y^2 + z^2), rounded to nearest.
template <AnyQuantity Q>
[[nodiscard]] Q hypotenuse(Q x, Q y, Q z) {
  const auto square = [](Q q) { return static_cast<std::uint64_t>(std::int64_t{q.raw()} * q.raw()); };
  return Q::from_wide_raw(integer_square_root_rounded(square(x) + square(y) + square(z)));
}

}  // namespace koboshi::fixed
