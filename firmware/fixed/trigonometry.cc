#include "firmware/fixed/trigonometry.h"

#include <array>
#include <bit>

#include "firmware/fixed/arc_tangent_table.h"
#include "firmware/fixed/rounding.h"

namespace koboshi::fixed {
namespace {

constexpr std::uint32_t kEighthTurnRaw = 1U << 29;
constexpr std::uint32_t kQuarterTurnRaw = 1U << 30;
constexpr std::uint32_t kHalfTurnRaw = 1U << 31;

// Sine and cosine of an angle of at most an eighth of a turn, from Chebyshev fits over t = angle / eighth
// turn in [0, 1]: sin = t (s0 - s1 z + s2 z^2 - ...), cos = 1 - z (c0 - c1 z + ...), z = t^2; fit errors
// 0.004 and 0.0003 LSB. t and z in 2^-31 units; coefficient k and its partial sum, which stays positive and
// below 1, in 2^-(32 + k): the unit of the upper word of z times the sum after it.
constexpr std::array<std::uint32_t, 5> kSine = {3373259426, 693598667, 42784630, 1256618, 21234};
constexpr std::array<std::uint32_t, 5> kCosine = {1324675879, 136187780, 5600496, 123372, 1672};

constexpr std::uint32_t upper_word(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint32_t>(std::uint64_t{a} * b >> 32);
}

constexpr std::uint32_t square_q31(std::uint32_t t) {
  return static_cast<std::uint32_t>(std::uint64_t{t} * t >> 31);
}

constexpr std::uint32_t alternating_sum(const std::array<std::uint32_t, 5>& c, std::uint32_t z) {
  std::uint32_t sum = c[3] - upper_word(c[4], z);
  sum = c[2] - upper_word(sum, z);
  sum = c[1] - upper_word(sum, z);
  return c[0] - upper_word(sum, z);
}

constexpr std::int32_t sine_kernel(std::uint32_t angle_raw) {
  const std::uint32_t t = angle_raw << 2;
  return static_cast<std::int32_t>((upper_word(alternating_sum(kSine, square_q31(t)), t) + 1) >> 1);
}

constexpr std::int32_t cosine_kernel(std::uint32_t angle_raw) {
  const std::uint32_t z = square_q31(angle_raw << 2);
  return static_cast<std::int32_t>(((1U << 31) - upper_word(alternating_sum(kCosine, z), z) + 1) >> 1);
}

// Where the two meet either may be taken.
static_assert(sine_kernel(kEighthTurnRaw) == cosine_kernel(kEighthTurnRaw));

// An angle in [0, 1/2] turn to the one in [0, 1/4] with the same sine.
constexpr std::uint32_t fold_to_quarter(std::uint32_t angle_raw) {
  return angle_raw <= kQuarterTurnRaw ? angle_raw : kHalfTurnRaw - angle_raw;
}

// a * b in 2^-31 units, rounded down.
constexpr std::int32_t product_q31(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(std::int64_t{a} * b >> 31);
}

// atan(ratio) for a ratio in [0, 1] in 2^-31 units; in raw Angle, [0, 1/8] turn.
constexpr std::uint32_t arc_tangent(std::uint32_t ratio) {
  if (ratio >> 31 != 0) return kEighthTurnRaw;
  const std::uint32_t segment = ratio >> 27;
  const auto& c = kArcTangent[segment];
  // The distance from the segment's centre in half segments, 2^-31 units.
  const std::int32_t d =
      (static_cast<std::int32_t>(ratio) - static_cast<std::int32_t>((2 * segment + 1) << 26)) * 32;
  std::int32_t sum = c[3] + product_q31(c[4], d);
  sum = c[2] + product_q31(sum, d);
  sum = c[1] + product_q31(sum, d);
  sum = c[0] + product_q31(sum, d);
  return (static_cast<std::uint32_t>(sum) + 2) >> 2;
}

// 1 / sqrt(f) in 2^-8 units, less the 256 that all have, by the top seven bits i of f in [1/4, 1):
// root^2 (i + 1/2) / 128 <= 2^16.
constexpr auto kInverseRoot = [] {
  std::array<std::uint8_t, 96> table{};
  for (std::uint32_t i = 32; i < 128; ++i) {
    std::uint32_t root = 256;
    while (root < 511 && (root + 1) * (root + 1) * (2 * i + 1) <= 1U << 24) ++root;
    table[i - 32] = static_cast<std::uint8_t>(root - 256);
  }
  return table;
}();

// 1 / sqrt(f) in 2^-30 units for f in [1/4, 1) in 2^-32 units, to 2^-24 of itself: two Newton steps
// y <- y (3 - f y^2) / 2 from a table of eight bits.
constexpr std::uint64_t inverse_root(std::uint32_t f) {
  const std::uint64_t y0 = 256U + kInverseRoot[(f >> 25) - 32];        // 2^-8
  const std::uint64_t y1 = y0 * ((3ULL << 48) - f * (y0 * y0)) >> 27;  // 2^-30
  return y1 * (((3ULL << 62) - f * (y1 * y1 >> 30)) >> 32) >> 31;
}

// low / high in 2^-31 units, rounded, for low <= high, high > 0.
constexpr std::uint32_t ratio_q31(std::uint32_t low, std::uint32_t high) {
  return static_cast<std::uint32_t>(((std::uint64_t{low} << 31) + high / 2) / high);
}
static_assert(ratio_q31(1, 3) == 715827883 && ratio_q31(5, 5) == 1U << 31 &&
              ratio_q31(1U << 31, 1U << 31) == 1U << 31);
static_assert(ratio_q31(0x7FFFFFFE, 0x7FFFFFFF) == 0x7FFFFFFF && ratio_q31(0, 1) == 0 &&
              ratio_q31(3, 0x80000000) == 3);

Ratio clamp_to_one(Ratio ratio) { return ratio < -kOne ? -kOne : ratio > kOne ? kOne : ratio; }

// sqrt(1 - ratio^2) for |ratio| <= 1
std::int32_t complement_raw(Ratio ratio) {
  const std::int64_t square = std::int64_t{ratio.raw()} * ratio.raw();
  return static_cast<std::int32_t>(
      integer_square_root_rounded(static_cast<std::uint64_t>((1LL << 60) - square)));
}

}  // namespace

Ratio sin(Angle angle) { return sin_cos(angle).sine; }

Ratio cos(Angle angle) { return sin_cos(angle).cosine; }

SineCosine sin_cos(Angle angle) {
  const std::uint32_t turned = magnitude(angle.raw());
  const std::uint32_t quarter = fold_to_quarter(turned);
  const bool steep = quarter <= kEighthTurnRaw;
  const std::uint32_t eighth = steep ? quarter : kQuarterTurnRaw - quarter;
  const std::int32_t small = sine_kernel(eighth);
  const std::int32_t large = cosine_kernel(eighth);
  const std::int32_t sine = steep ? small : large;
  const std::int32_t cosine = steep ? large : small;
  return {Ratio::from_raw(angle.raw() < 0 ? -sine : sine),
          Ratio::from_raw(turned > kQuarterTurnRaw ? -cosine : cosine)};
}

std::uint32_t integer_square_root(std::uint64_t value) {
  if (value == 0) return 0;
  const int shift = std::countl_zero(value) & ~1;
  const std::uint64_t scaled = value << shift;
  const auto f = static_cast<std::uint32_t>(scaled >> 32);
  const std::uint64_t y = inverse_root(f);
  std::uint64_t root = f * y >> 30;  // to 2^-24 of itself
  // One Newton step on the root itself, then the last unit.
  const auto error = static_cast<std::int64_t>(scaled - root * root);
  root += static_cast<std::uint64_t>((error >> 16) * static_cast<std::int64_t>(y) >> 47);
  if (root > 0xFFFFFFFF) root = 0xFFFFFFFF;
  if (root * root > scaled) --root;
  if (scaled - root * root > 2 * root) ++root;
  return static_cast<std::uint32_t>(root >> (shift / 2));
}

std::uint32_t integer_square_root_rounded(std::uint64_t value) {
  const std::uint32_t root = integer_square_root(value);
  const bool up = value - std::uint64_t{root} * root > root;
  return up && root != 0xFFFFFFFF ? root + 1 : root;
}

InverseRoot inverse_square_root(std::uint64_t value) {
  const int shift = std::countl_zero(value) & ~1;
  const std::uint64_t root = inverse_root(static_cast<std::uint32_t>(value << shift >> 32));
  return {static_cast<std::uint32_t>(root), 62 - shift / 2};
}

Angle atan2_raw(std::int32_t y, std::int32_t x) {
  const std::uint32_t dx = magnitude(x);
  const std::uint32_t dy = magnitude(y);
  const std::uint32_t low = dx < dy ? dx : dy;
  const std::uint32_t high = dx < dy ? dy : dx;
  if (high == 0) return Angle();
  std::uint32_t angle = arc_tangent(ratio_q31(low, high));
  if (dy > dx) angle = kQuarterTurnRaw - angle;
  if (x < 0) angle = kHalfTurnRaw - angle;
  return Angle::from_raw(static_cast<std::int32_t>(y < 0 ? 0U - angle : angle));
}

Angle asin(Ratio sine) {
  const Ratio clamped = clamp_to_one(sine);
  return atan2_raw(clamped.raw(), complement_raw(clamped));
}

Angle acos(Ratio cosine) {
  const Ratio clamped = clamp_to_one(cosine);
  if (clamped == -kOne) return Angle::max();
  return atan2_raw(complement_raw(clamped), clamped.raw());
}

}  // namespace koboshi::fixed
