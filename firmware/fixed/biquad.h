#pragma once

#include <cstdint>

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
  struct Output {
    std::int32_t whole = 0;
    std::int32_t fraction = 0;  // 2^-30 LSB, never negative
  };

  std::int32_t input_1_ = 0;
  std::int32_t input_2_ = 0;
  Output output_1_;
  Output output_2_;
};

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
