#pragma once

#include <cstdint>
#include <limits>

#include "firmware/fixed/units.h"

namespace koboshi::fixed {

// H(z) = (b0 + b1 z^-1 + b2 z^-2) / (1 + a1 z^-1 + a2 z^-2). Designed on the host, `host/filter_design.h`.
struct BiquadCoefficients {
  Ratio b0;
  Ratio b1;
  Ratio b2;
  Ratio a1;
  Ratio a2;

  friend bool operator==(const BiquadCoefficients&, const BiquadCoefficients&) = default;
};

// A second-order section on raw numbers, direct form I. The past outputs keep 30 bits below the LSB; without
// them a filter whose poles are close to 1 stops short of a constant input, or circles around it. Starts
// settled at zero. Coefficients of a filter that amplifies no signal beyond 4 times full scale; what exceeds
// 32 bits saturates.
class BiquadFilter {
 public:
  // As after an endless constant input of `value_raw`, if the gain at DC is 1.
  void reset(std::int32_t value_raw);
  // Takes the next input; returns the output of the same instant, rounded to nearest.
  [[nodiscard]] std::int32_t filter(const BiquadCoefficients& coefficients, std::int32_t input_raw);

 private:
  static constexpr int kFractionBits = Ratio::kFractionBits;  // of a coefficient, and of an output's fraction
  static constexpr std::int64_t kMaximum = std::int64_t{std::numeric_limits<std::int32_t>::max()}
                                           << kFractionBits;
  static constexpr std::int64_t kMinimum = -kMaximum - (std::int64_t{1} << kFractionBits);

  // Modulo 2^64: partial sums may overflow, what counts is that the whole sum does not.
  static std::uint64_t multiply(Ratio coefficient, std::int64_t value) {
    return static_cast<std::uint64_t>(coefficient.raw() * value);
  }
  static std::int64_t saturated(std::int64_t sum);

  struct Output {
    std::int32_t whole = 0;
    std::int32_t fraction = 0;  // 2^-30 LSB, never negative
  };

  std::int32_t input_1_ = 0;
  std::int32_t input_2_ = 0;
  Output output_1_;
  Output output_2_;
};

inline std::int64_t BiquadFilter::saturated(std::int64_t sum) {
  // Nearly always true; the upper half alone tells.
  constexpr auto kLowest = static_cast<std::uint32_t>(kMinimum >> 32);
  constexpr auto kHighest = static_cast<std::uint32_t>(kMaximum >> 32);
  if (static_cast<std::uint32_t>(sum >> 32) - kLowest < kHighest - kLowest) return sum;
  return sum < kMinimum ? kMinimum : sum > kMaximum ? kMaximum : sum;
}

// Here, so that the six channels of an inertial unit cost no calls at 1 kHz.
inline std::int32_t BiquadFilter::filter(const BiquadCoefficients& c, std::int32_t input_raw) {
  constexpr std::int64_t kHalf = std::int64_t{1} << (kFractionBits - 1);
  constexpr std::int32_t kFractionMask = (1 << kFractionBits) - 1;
  const std::int64_t from_fractions = (std::int64_t{c.a1.raw()} * output_1_.fraction +
                                       std::int64_t{c.a2.raw()} * output_2_.fraction + kHalf) >>
                                      kFractionBits;
  const std::uint64_t from_outputs = static_cast<std::uint64_t>(from_fractions) +
                                     multiply(c.a1, output_1_.whole) + multiply(c.a2, output_2_.whole);
  const std::uint64_t from_inputs =
      multiply(c.b0, input_raw) + multiply(c.b1, input_1_) + multiply(c.b2, input_2_);
  const std::int64_t output = saturated(static_cast<std::int64_t>(from_inputs - from_outputs));

  input_2_ = input_1_;
  input_1_ = input_raw;
  output_2_ = output_1_;
  output_1_ = {.whole = static_cast<std::int32_t>(output >> kFractionBits),
               .fraction = static_cast<std::int32_t>(output) & kFractionMask};
  // Rounded; the largest has no fraction.
  return output_1_.whole + (output_1_.fraction >> (kFractionBits - 1));
}

// The paper's filter for noisy sensors, for one channel of one quantity.
template <AnyQuantity Q>
class LowPass {
 public:
  explicit constexpr LowPass(const BiquadCoefficients& coefficients) : coefficients_(coefficients) {}

  // As after an endless constant input of `value`.
  void reset(Q value) { filter_.reset(value.raw()); }
  // Takes the next sample; returns the filtered signal at its instant.
  [[nodiscard]] Q filter(Q sample) { return Q::from_raw(filter_.filter(coefficients_, sample.raw())); }

 private:
  BiquadCoefficients coefficients_;
  BiquadFilter filter_;
};

}  // namespace koboshi::fixed
