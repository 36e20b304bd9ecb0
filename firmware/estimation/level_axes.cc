#include "firmware/estimation/level_axes.h"

#include <cstdint>

#include "firmware/fixed/literals.h"
#include "firmware/fixed/rounding.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::estimation {

using fixed::Ratio;
using robot::Direction;
using namespace fixed::literals;

namespace {

constexpr Ratio kLeastLevel = 0.5_ratio;  // cos 60 degrees: the length of up x forward

}  // namespace

std::optional<LevelAxes> level_axes(const robot::Rotation& R_BSole, const Direction& up_B) {
  const Direction forward_B{R_BSole.rows[0].x, R_BSole.rows[1].x, R_BSole.rows[2].x};
  const Direction left = cross(up_B, forward_B);
  const auto square = [](Ratio ratio) {
    return static_cast<std::uint64_t>(std::int64_t{ratio.raw()} * ratio.raw());
  };
  const std::uint64_t length_squared = square(left.x) + square(left.y) + square(left.z);
  if (length_squared < square(kLeastLevel)) return std::nullopt;
  // One inverse root instead of a root and three divisions; it is exact to 2^-23.
  const auto [mantissa, shift] = fixed::inverse_square_root(length_squared);
  const auto over_length = [&, mantissa = mantissa, shift = shift](Ratio ratio) {
    return Ratio::from_wide_raw(
        fixed::shift_rounded(std::int64_t{ratio.raw()} * mantissa, shift - Ratio::kFractionBits));
  };
  const Direction unit{over_length(left.x), over_length(left.y), over_length(left.z)};
  return LevelAxes{.forward = cross(unit, up_B), .left = unit};
}

}  // namespace koboshi::estimation
