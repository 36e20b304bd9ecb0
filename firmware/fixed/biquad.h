#pragma once

#include <cstdint>

#include "firmware/fixed/units.h"

namespace koboshi::fixed {

// The coefficients of H(z) = (b0 + b1 z^-1 + b2 z^-2) / (1 + a1 z^-1 + a2 z^-2), designed on the host
// (host/filter_design.h).
struct BiquadCoefficients {
  Ratio b0;
  Ratio b1;
  Ratio b2;
  Ratio a1;
  Ratio a2;

  friend bool operator==(const BiquadCoefficients&, const BiquadCoefficients&) = default;
};

// A second-order section (biquad) on raw numbers, in direct form I. Past outputs keep 30 fraction bits below
// the LSB; without them, a filter with poles close to 1 would stop short of a constant input or show limit
// cycles. It starts settled at zero. Outputs beyond 32 bits saturate; intermediate values fit as long as the
// filter amplifies no signal beyond 4 times the full scale.
class BiquadFilter {
 public:
  // Sets the state after an endless constant input of `value_raw`, for a DC gain of 1.
  void reset(std::int32_t value_raw);
  // Takes the next input and returns the output of the same instant, rounded to nearest.
  [[nodiscard]] std::int32_t filter(const BiquadCoefficients& coefficients, std::int32_t input_raw);

 private:
  struct Output {
    std::int32_t whole = 0;
    std::int32_t fraction = 0;  // 2^-30 LSB, never negative
  };

  std::int32_t input_1_ = 0;
  std::int32_t input_2_ = 0;
  Output output_1_;
  Output output_2_;
};

// The paper's second-order low-pass for noisy sensors, for one channel of a quantity.
template <AnyQuantity Q>
class LowPass {
 public:
  explicit constexpr LowPass(const BiquadCoefficients& coefficients) : coefficients_(coefficients) {}

  // Sets the state after an endless constant input of `value`.
  void reset(Q value) { filter_.reset(value.raw()); }
  // Takes the next sample and returns the filtered value of the same instant.
  [[nodiscard]] Q filter(Q sample) { return Q::from_raw(filter_.filter(coefficients_, sample.raw())); }

 private:
  BiquadCoefficients coefficients_;
  BiquadFilter filter_;
};

}  // namespace koboshi::fixed
