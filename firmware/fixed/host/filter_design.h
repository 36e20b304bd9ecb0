#pragma once

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "firmware/fixed/biquad.h"
#include "firmware/fixed/host/convert.h"

namespace koboshi::fixed {

// A Butterworth low-pass of second order: -3 dB at `cutoff_Hz`, gain at DC exactly 1. The analogue prototype
// 1 / (s^2 + sqrt(2) s + 1) under the bilinear transform s = (1 - z^-1) / (K (1 + z^-1)), prewarped to the
// cut-off by K = tan(pi cutoff / sample rate). Throws std::domain_error unless sample rate / 10000 <= cutoff
// <= 0.45 sample rates: below it the coefficients' rounding bends the response by more than 1 %, above it
// there is no filter left.
[[nodiscard]] inline BiquadCoefficients design_low_pass(double cutoff_Hz, double sample_rate_Hz) {
  if (!(cutoff_Hz >= 1e-4 * sample_rate_Hz && cutoff_Hz <= 0.45 * sample_rate_Hz)) {
    throw std::domain_error("a low-pass needs a cut-off in 0.0001..0.45 of its sample rate");
  }
  const double k = std::tan(std::numbers::pi * cutoff_Hz / sample_rate_Hz);
  const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
  BiquadCoefficients c;
  c.b0 = from_double<Ratio>(k * k * scale);
  c.b1 = c.b0 * 2;
  c.b2 = c.b0;
  c.a2 = from_double<Ratio>((1.0 - std::numbers::sqrt2 * k + k * k) * scale);
  // a1 takes up the rounding of the others, for then b0 + b1 + b2 = 1 + a1 + a2 to the last bit.
  c.a1 = Ratio::from_wide_raw(4 * std::int64_t{c.b0.raw()} - kOne.raw() - c.a2.raw());
  return c;
}

}  // namespace koboshi::fixed
