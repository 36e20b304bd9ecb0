#include <bit>
#include <cmath>

#include "tests/bench/target_kernels/kernel.h"

namespace koboshi::bench {
namespace {

std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }
float as_float(std::uint32_t bits) { return std::bit_cast<float>(bits); }

std::uint32_t sine(std::uint32_t a, std::uint32_t) { return bits(std::sin(as_float(a))); }
std::uint32_t cosine(std::uint32_t a, std::uint32_t) { return bits(std::cos(as_float(a))); }
std::uint32_t arc_tangent(std::uint32_t y, std::uint32_t x) {
  return bits(std::atan2(as_float(y), as_float(x)));
}
std::uint32_t root(std::uint32_t a, std::uint32_t) { return bits(std::sqrt(as_float(a))); }
std::uint32_t multiply(std::uint32_t a, std::uint32_t b) { return bits(as_float(a) * as_float(b)); }
std::uint32_t divide(std::uint32_t a, std::uint32_t b) { return bits(as_float(a) / as_float(b)); }

// 20 Hz at 1 kHz, direct form I like the fixed-point filter.
std::uint32_t biquad(std::uint32_t a, std::uint32_t) {
  constexpr float kB0 = 0.0036216815F, kB1 = 0.007243363F, kB2 = 0.0036216815F;
  constexpr float kA1 = -1.8226949F, kA2 = 0.8371816F;
  static float x1 = 0.0F, x2 = 0.0F, y1 = 0.0F, y2 = 0.0F;
  const float x0 = as_float(a);
  const float y0 = kB0 * x0 + kB1 * x1 + kB2 * x2 - kA1 * y1 - kA2 * y2;
  x2 = x1;
  x1 = x0;
  y2 = y1;
  y1 = y0;
  return bits(y0);
}

// The domains of the fixed-point kernels, in their units.
std::uint32_t scaled(std::uint32_t u, float scale, float offset) {
  return bits(static_cast<float>(u >> 8) * (scale / 16'777'216.0F) + offset);
}
std::uint32_t turn(std::uint32_t u, std::uint32_t) { return scaled(u, 6.2831853F, -3.1415927F); }
std::uint32_t two(std::uint32_t u, std::uint32_t) { return scaled(u, 4.0F, -2.0F); }
std::uint32_t positive(std::uint32_t u, std::uint32_t) { return scaled(u, 2.0F, 0.0F); }
std::uint32_t one_to_two(std::uint32_t u, std::uint32_t) { return scaled(u, 1.0F, 1.0F); }
std::uint32_t below_one(std::uint32_t u, std::uint32_t) { return scaled(u, 1.0F, 0.0F); }

constexpr Contestant kContestants[] = {
    {"sinf", sine, turn},
    {"cosf", cosine, turn},
    {"atan2f", arc_tangent, two},
    {"sqrtf", root, positive},
    {"*", multiply, two},
    {"/", divide, one_to_two},
    {"float biquad", biquad, below_one},
};

}  // namespace

std::span<const Contestant, 7> float_kernels() { return kContestants; }

}  // namespace koboshi::bench
