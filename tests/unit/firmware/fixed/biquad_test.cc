#include "firmware/fixed/biquad.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

#include "firmware/fixed/host/convert.h"
#include "firmware/fixed/host/filter_design.h"
#include "firmware/fixed/literals.h"
#include "tests/support/seed.h"

namespace koboshi::fixed {
namespace {

using namespace literals;

constexpr double kSampleRate_Hz = 1000.0;
constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();
constexpr std::int32_t kMin = std::numeric_limits<std::int32_t>::min();
constexpr double kCutoffs_Hz[] = {0.1, 1.0, 5.0, 20.0, 98.0, 256.0, 450.0};

// The same filter in double, directly from its difference equation.
class Reference {
 public:
  explicit Reference(const BiquadCoefficients& c) : c_(c) {}

  double filter(double x0) {
    const double y0 = to_double(c_.b0) * x0 + to_double(c_.b1) * x1_ + to_double(c_.b2) * x2_ -
                      to_double(c_.a1) * y1_ - to_double(c_.a2) * y2_;
    x2_ = x1_;
    x1_ = x0;
    y2_ = y1_;
    y1_ = y0;
    return y0;
  }

 private:
  BiquadCoefficients c_;
  double x1_ = 0.0, x2_ = 0.0, y1_ = 0.0, y2_ = 0.0;
};

// |H| of the analogue Butterworth prototype at the frequency to which the bilinear transform maps
// `frequency_Hz`.
double butterworth_gain(double frequency_Hz, double cutoff_Hz) {
  const double warped = std::tan(std::numbers::pi * frequency_Hz / kSampleRate_Hz) /
                        std::tan(std::numbers::pi * cutoff_Hz / kSampleRate_Hz);
  return 1.0 / std::sqrt(1.0 + std::pow(warped, 4));
}

// Returns the amplitude of the response to a sine, by correlation over whole periods after the transient.
double measured_gain(const BiquadCoefficients& coefficients, int period_samples, double amplitude_raw) {
  BiquadFilter filter;
  const int settle = 200 * period_samples;
  const int measure = 100 * period_samples;
  std::complex<double> sum;
  for (int n = 0; n < settle + measure; ++n) {
    const double phase = 2.0 * std::numbers::pi * (n % period_samples) / period_samples;
    const std::int32_t out =
        filter.filter(coefficients, static_cast<std::int32_t>(std::lround(amplitude_raw * std::sin(phase))));
    if (n >= settle) sum += static_cast<double>(out) * std::polar(1.0, -phase);
  }
  return 2.0 * std::abs(sum) / measure / amplitude_raw;
}

TEST(DesignLowPass, HasAGainOfExactlyOneAtDc) {
  for (const double cutoff_Hz : kCutoffs_Hz) {
    const BiquadCoefficients c = design_low_pass(cutoff_Hz, kSampleRate_Hz);
    EXPECT_EQ(std::int64_t{c.b0.raw()} + c.b1.raw() + c.b2.raw(),
              (std::int64_t{1} << 30) + c.a1.raw() + c.a2.raw());
  }
}

TEST(DesignLowPass, RejectsCutOffFrequenciesOutOfRange) {
  EXPECT_THROW(static_cast<void>(design_low_pass(0.09, 1000.0)), std::domain_error);
  EXPECT_THROW(static_cast<void>(design_low_pass(451.0, 1000.0)), std::domain_error);
  EXPECT_THROW(static_cast<void>(design_low_pass(-20.0, 1000.0)), std::domain_error);
  EXPECT_THROW(static_cast<void>(design_low_pass(20.0, 0.0)), std::domain_error);
  EXPECT_THROW(static_cast<void>(design_low_pass(std::nan(""), 1000.0)), std::domain_error);
}

// Evaluates the fixed-point coefficients over all frequencies.
TEST(DesignLowPass, IsAButterworthWithinOnePercent) {
  for (const double cutoff_Hz : kCutoffs_Hz) {
    const BiquadCoefficients c = design_low_pass(cutoff_Hz, kSampleRate_Hz);
    for (double frequency_Hz = 0.01; frequency_Hz < 490.0; frequency_Hz *= 1.1) {
      const std::complex<double> z1 =
          std::polar(1.0, -2.0 * std::numbers::pi * frequency_Hz / kSampleRate_Hz);
      const std::complex<double> h = (to_double(c.b0) + to_double(c.b1) * z1 + to_double(c.b2) * z1 * z1) /
                                     (1.0 + to_double(c.a1) * z1 + to_double(c.a2) * z1 * z1);
      const double expected = butterworth_gain(frequency_Hz, cutoff_Hz);
      ASSERT_NEAR(std::abs(h), expected, 0.01 * expected) << cutoff_Hz << " Hz at " << frequency_Hz << " Hz";
    }
  }
}

TEST(BiquadFilter, PassesSinesAsAButterworth) {
  const BiquadCoefficients c = design_low_pass(20.0, kSampleRate_Hz);
  for (const int period_samples : {1000, 200, 100, 50, 25, 10, 4}) {
    const double expected = butterworth_gain(kSampleRate_Hz / period_samples, 20.0);
    EXPECT_NEAR(measured_gain(c, period_samples, 1e6), expected, 1e-5) << period_samples;
  }
  EXPECT_NEAR(measured_gain(c, 50, 1e6), std::numbers::sqrt2 / 2.0, 1e-5);
}

TEST(BiquadFilter, FollowsTheDoubleFilterWithinHalfAnLsb) {
  using test::kSeed;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  for (const double cutoff_Hz : kCutoffs_Hz) {
    const BiquadCoefficients c = design_low_pass(cutoff_Hz, kSampleRate_Hz);
    BiquadFilter filter;
    Reference reference(c);
    std::mt19937 random(kSeed);
    for (int n = 0; n < 20'000; ++n) {
      const std::int32_t in =
          (n / 1'000 % 2 == 0 ? 700'000'000 : -700'000'000) + static_cast<std::int32_t>(random() % 1'000'000);
      ASSERT_NEAR(filter.filter(c, in), reference.filter(in), 0.51) << cutoff_Hz << " Hz, sample " << n;
    }
  }
}

TEST(BiquadFilter, SettlesOnAnyConstantInputWithoutALimitCycle) {
  for (const double cutoff_Hz : kCutoffs_Hz) {
    const BiquadCoefficients c = design_low_pass(cutoff_Hz, kSampleRate_Hz);
    const int settle = static_cast<int>(10.0 * kSampleRate_Hz / cutoff_Hz) + 100;
    BiquadFilter filter;
    for (const std::int32_t in :
         {1, 0, -1, 2, 12'345'678, 12'345'679, -1'000'000'000, 0x7FFFFFFF, -0x7FFFFFFF - 1, 0}) {
      for (int n = 0; n < settle; ++n) static_cast<void>(filter.filter(c, in));
      for (int n = 0; n < 1'000; ++n) ASSERT_EQ(filter.filter(c, in), in) << cutoff_Hz << " Hz";
    }
  }
}

TEST(BiquadFilter, OvershootsAFullScaleStepIntoSaturation) {
  const BiquadCoefficients c = design_low_pass(20.0, kSampleRate_Hz);
  BiquadFilter filter;
  filter.reset(-0x7FFFFFFF - 1);
  std::int32_t last = -0x7FFFFFFF - 1;
  for (int n = 0; n < 34; ++n) {  // the step response rises to its peak at 1 / (sqrt(2) cut-off) = 35 samples
    const std::int32_t out = filter.filter(c, 0x7FFFFFFF);
    ASSERT_GE(out, last);
    last = out;
  }
  EXPECT_EQ(last, 0x7FFFFFFF);
}

TEST(BiquadFilter, SaturatesUpToFourTimesFullScale) {
  const BiquadCoefficients fourfold{.b0 = Ratio::max(), .b1 = Ratio::max(), .b2 = {}, .a1 = {}, .a2 = {}};
  BiquadFilter filter;
  for (const std::int32_t in : {kMax, kMax, kMin}) static_cast<void>(filter.filter(fourfold, in));
  EXPECT_EQ(filter.filter(fourfold, kMin), kMin);
  EXPECT_EQ(filter.filter(fourfold, kMax), -2);  // nearly 2 of each input
  EXPECT_EQ(filter.filter(fourfold, kMax), kMax);
}

TEST(BiquadFilter, RoundsUpToTheLargestValueAndSaturates) {
  const BiquadCoefficients c{.b0 = Ratio::from_raw(1 << 29), .b1 = kOne, .b2 = {}, .a1 = {}, .a2 = {}};
  for (const std::int32_t last : {0x3FFFFFFF, 0x40000000}) {  // half an LSB below the largest, and above it
    BiquadFilter filter;
    static_cast<void>(filter.filter(c, last));
    EXPECT_EQ(filter.filter(c, kMax), kMax);
  }
}

TEST(BiquadFilter, HoldsTheValueOfItsReset) {
  const BiquadCoefficients c = design_low_pass(20.0, kSampleRate_Hz);
  BiquadFilter filter;
  for (const std::int32_t value : {0, 1, -77'777, 0x7FFFFFFF, -0x7FFFFFFF - 1}) {
    filter.reset(value);
    for (int n = 0; n < 100; ++n) ASSERT_EQ(filter.filter(c, value), value);
  }
}

TEST(LowPass, FiltersAQuantity) {
  LowPass<AngularRate> low_pass(design_low_pass(20.0, kSampleRate_Hz));
  low_pass.reset(30.0_deg_per_s);
  EXPECT_EQ(low_pass.filter(30.0_deg_per_s), 30.0_deg_per_s);
  AngularRate out;
  for (int n = 0; n < 12; ++n) out = low_pass.filter(0.0_deg_per_s);
  EXPECT_GT(out, 10.0_deg_per_s);  // the step response reaches a half after 0.23 / cut-off = 11.5 samples
  EXPECT_LT(out, 20.0_deg_per_s);
}

}  // namespace
}  // namespace koboshi::fixed
