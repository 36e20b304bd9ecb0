// The numeric kernels against libfixmath: time, and maximum error against double, of the same computation in
// each library's own formats, side by side. Errors are absolute, in rad for angles, and against the exact
// function of the rounded argument. Debian builds libfixmath with its caches of sines and arc tangents and
// without optimisation; 65536 inputs leave the caches cold.
#include <benchmark/benchmark.h>
#include <libfixmath/fixmath.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "firmware/fixed/biquad.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/fixed/host/filter_design.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::fixed {
namespace {

constexpr int kCases = 65'536;

template <typename T>
double real(T value) {
  if constexpr (std::same_as<T, fix16_t>) {
    return fix16_to_dbl(value);
  } else {
    return to_double(value);
  }
}

template <typename T>
T rounded(double value) {
  if constexpr (std::same_as<T, fix16_t>) {
    return fix16_from_dbl(value);
  } else {
    return from_double<T>(value);
  }
}

// Pairs of uniform numbers, the same for both libraries.
template <typename A, typename B>
std::vector<std::pair<A, B>> draw(double low, double high) {
  std::mt19937 random(20080114);
  const auto next = [&] { return low + (high - low) * std::ldexp(random(), -32); };
  std::vector<std::pair<A, B>> pairs(kCases);
  for (auto& [a, b] : pairs) {
    a = rounded<A>(next());
    b = rounded<B>(next());
  }
  return pairs;
}

template <typename A, typename B, typename Kernel, typename Exact>
void measure(benchmark::State& state, double low, double high, Kernel kernel, Exact exact) {
  const auto inputs = draw<A, B>(low, high);
  for (auto _ : state) {
    for (const auto& [a, b] : inputs) {
      auto result = kernel(a, b);
      benchmark::DoNotOptimize(result);
    }
  }
  double error = 0.0;
  for (const auto& [a, b] : inputs) {
    error = std::max(error, std::abs(real(kernel(a, b)) - exact(real(a), real(b))));
  }
  state.counters["max_error"] = error;
  state.counters["time_each"] = benchmark::Counter(static_cast<double>(state.iterations()) * kCases,
                                                   benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

constexpr double kPi = std::numbers::pi;
const auto kSin = [](double x, double) { return std::sin(x); };
const auto kCos = [](double x, double) { return std::cos(x); };
const auto kAtan2 = [](double y, double x) { return std::atan2(y, x); };
const auto kSqrt = [](double x, double) { return std::sqrt(x); };
const auto kMultiply = [](double x, double y) { return x * y; };
const auto kDivide = [](double x, double y) { return x / y; };

void sin_koboshi(benchmark::State& state) {
  measure<Angle, Angle>(
      state, -kPi, kPi, [](Angle a, Angle) { return sin(a); }, kSin);
}
void sin_libfixmath(benchmark::State& state) {
  measure<fix16_t, fix16_t>(
      state, -kPi, kPi, [](fix16_t a, fix16_t) { return fix16_sin(a); }, kSin);
}
void cos_koboshi(benchmark::State& state) {
  measure<Angle, Angle>(
      state, -kPi, kPi, [](Angle a, Angle) { return cos(a); }, kCos);
}
void cos_libfixmath(benchmark::State& state) {
  measure<fix16_t, fix16_t>(
      state, -kPi, kPi, [](fix16_t a, fix16_t) { return fix16_cos(a); }, kCos);
}
void atan2_koboshi(benchmark::State& state) {
  measure<Length, Length>(
      state, -2.0, 2.0, [](Length y, Length x) { return atan2(y, x); }, kAtan2);
}
void atan2_libfixmath(benchmark::State& state) {
  measure<fix16_t, fix16_t>(
      state, -2.0, 2.0, [](fix16_t y, fix16_t x) { return fix16_atan2(y, x); }, kAtan2);
}
void sqrt_koboshi(benchmark::State& state) {
  measure<Ratio, Ratio>(
      state, 0.0, 1.99, [](Ratio a, Ratio) { return square_root<Ratio>(a); }, kSqrt);
}
void sqrt_libfixmath(benchmark::State& state) {
  measure<fix16_t, fix16_t>(
      state, 0.0, 1.99, [](fix16_t a, fix16_t) { return fix16_sqrt(a); }, kSqrt);
}
void multiply_koboshi(benchmark::State& state) {
  measure<Length, Ratio>(
      state, -1.99, 1.99, [](Length a, Ratio b) { return product<Length>(a, b); }, kMultiply);
}
void multiply_libfixmath(benchmark::State& state) {
  measure<fix16_t, fix16_t>(
      state, -1.99, 1.99, [](fix16_t a, fix16_t b) { return fix16_mul(a, b); }, kMultiply);
}
// Quotients in 1/2..2: the range of the narrower format.
void divide_koboshi(benchmark::State& state) {
  measure<Length, Length>(
      state, 1.0, 1.99, [](Length a, Length b) { return quotient<Ratio>(a, b); }, kDivide);
}
void divide_libfixmath(benchmark::State& state) {
  measure<fix16_t, fix16_t>(
      state, 1.0, 1.99, [](fix16_t a, fix16_t b) { return fix16_div(a, b); }, kDivide);
}

// 20 Hz at 1 kHz. libfixmath has no filter: this is the same difference equation in its arithmetic.
class Fix16Biquad {
 public:
  fix16_t filter(fix16_t x0) {
    const fix16_t y0 = fix16_mul(b0_, x0) + fix16_mul(b1_, x1_) + fix16_mul(b2_, x2_) - fix16_mul(a1_, y1_) -
                       fix16_mul(a2_, y2_);
    x2_ = x1_;
    x1_ = x0;
    y2_ = y1_;
    y1_ = y0;
    return y0;
  }

 private:
  static inline const BiquadCoefficients kDesign = design_low_pass(20.0, 1000.0);
  fix16_t b0_ = fix16_from_dbl(to_double(kDesign.b0)), b1_ = fix16_from_dbl(to_double(kDesign.b1)),
          b2_ = fix16_from_dbl(to_double(kDesign.b2)), a1_ = fix16_from_dbl(to_double(kDesign.a1)),
          a2_ = fix16_from_dbl(to_double(kDesign.a2));
  fix16_t x1_ = 0, x2_ = 0, y1_ = 0, y2_ = 0;
};

class DoubleBiquad {
 public:
  double filter(double x0) {
    const double k = std::tan(kPi * 20.0 / 1000.0);
    const double norm = 1.0 + std::numbers::sqrt2 * k + k * k;
    const double y0 = (k * k * (x0 + 2.0 * x1_ + x2_) - 2.0 * (k * k - 1.0) * y1_ -
                       (1.0 - std::numbers::sqrt2 * k + k * k) * y2_) /
                      norm;
    x2_ = x1_;
    x1_ = x0;
    y2_ = y1_;
    y1_ = y0;
    return y0;
  }

 private:
  double x1_ = 0.0, x2_ = 0.0, y1_ = 0.0, y2_ = 0.0;
};

// Filters the same noise for ever; the error is that of a fresh filter's first pass.
template <typename Q, typename Filter>
void measure_filter(benchmark::State& state, Filter filter) {
  Filter fresh = filter;
  const auto inputs = draw<Q, Q>(0.0, 1.0);
  for (auto _ : state) {
    for (const auto& input : inputs) {
      auto result = filter.filter(input.first);
      benchmark::DoNotOptimize(result);
    }
  }
  DoubleBiquad exact;
  double error = 0.0;
  for (const auto& input : inputs) {
    error = std::max(error, std::abs(real(fresh.filter(input.first)) - exact.filter(real(input.first))));
  }
  state.counters["max_error"] = error;
  state.counters["time_each"] = benchmark::Counter(static_cast<double>(state.iterations()) * kCases,
                                                   benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void biquad_koboshi(benchmark::State& state) {
  measure_filter<AngularRate>(state, LowPass<AngularRate>(design_low_pass(20.0, 1000.0)));
}
void biquad_libfixmath(benchmark::State& state) { measure_filter<fix16_t>(state, Fix16Biquad()); }

BENCHMARK(sin_koboshi);
BENCHMARK(sin_libfixmath);
BENCHMARK(cos_koboshi);
BENCHMARK(cos_libfixmath);
BENCHMARK(atan2_koboshi);
BENCHMARK(atan2_libfixmath);
BENCHMARK(sqrt_koboshi);
BENCHMARK(sqrt_libfixmath);
BENCHMARK(multiply_koboshi);
BENCHMARK(multiply_libfixmath);
BENCHMARK(divide_koboshi);
BENCHMARK(divide_libfixmath);
BENCHMARK(biquad_koboshi);
BENCHMARK(biquad_libfixmath);

}  // namespace
}  // namespace koboshi::fixed
