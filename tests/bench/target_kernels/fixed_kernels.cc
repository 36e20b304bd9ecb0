#include "firmware/estimation/inertial.h"
#include "firmware/fixed/biquad.h"
#include "firmware/fixed/trigonometry.h"
#include "tests/bench/target_kernels/kernel.h"

namespace koboshi::bench {
namespace {

using namespace fixed;

std::uint32_t bits(std::int32_t raw) { return static_cast<std::uint32_t>(raw); }
std::int32_t raw(std::uint32_t bits) { return static_cast<std::int32_t>(bits); }
template <typename Q>
Q as(std::uint32_t bits) {
  return Q::from_raw(raw(bits));
}

std::uint32_t sine(std::uint32_t a, std::uint32_t) { return bits(sin(as<Angle>(a)).raw()); }
std::uint32_t cosine(std::uint32_t a, std::uint32_t) { return bits(cos(as<Angle>(a)).raw()); }
std::uint32_t arc_tangent(std::uint32_t y, std::uint32_t x) {
  return bits(atan2(as<Length>(y), as<Length>(x)).raw());
}
std::uint32_t root(std::uint32_t a, std::uint32_t) { return bits(square_root<Ratio>(as<Ratio>(a)).raw()); }
std::uint32_t multiply(std::uint32_t a, std::uint32_t b) {
  return bits(product<Length>(as<Length>(a), as<Ratio>(b)).raw());
}
std::uint32_t divide(std::uint32_t a, std::uint32_t b) {
  return bits(quotient<Ratio>(as<Length>(a), as<Length>(b)).raw());
}
std::uint32_t biquad(std::uint32_t a, std::uint32_t) {
  static constinit LowPass<AngularRate> filter(estimation::kInertialLowPass);
  return bits(filter.filter(as<AngularRate>(a)).raw());
}

// Domains: the whole turn, +-2 m, [0, 2), +-128 m and +-2, [1, 2) m, [0, 1) turn/s.
std::uint32_t whole(std::uint32_t u, std::uint32_t) { return u; }
std::uint32_t two_meters(std::uint32_t u, std::uint32_t) { return bits(raw(u) >> 6); }
std::uint32_t positive(std::uint32_t u, std::uint32_t) { return u >> 1; }
std::uint32_t one_to_two(std::uint32_t u, std::uint32_t) { return (1U << 24) + (u >> 8); }
std::uint32_t below_one(std::uint32_t u, std::uint32_t) { return u >> 8; }

constexpr Contestant kContestants[] = {
    {"sin", sine, whole},          {"cos", cosine, whole},        {"atan2", arc_tangent, two_meters},
    {"sqrt", root, positive},      {"multiply", multiply, whole}, {"divide", divide, one_to_two},
    {"biquad", biquad, below_one},
};

}  // namespace

std::span<const Contestant, 7> fixed_kernels() { return kContestants; }

}  // namespace koboshi::bench
