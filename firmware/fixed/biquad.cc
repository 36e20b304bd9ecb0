#include "firmware/fixed/biquad.h"

#include <algorithm>
#include <limits>

namespace koboshi::fixed {
namespace {

constexpr int kFractionBits = Ratio::kFractionBits;  // of a coefficient, and of an output's fraction
constexpr std::int64_t kHalf = std::int64_t{1} << (kFractionBits - 1);
constexpr std::int32_t kFractionMask = (1 << kFractionBits) - 1;
constexpr std::int64_t kMaximum = std::int64_t{std::numeric_limits<std::int32_t>::max()} << kFractionBits;
constexpr std::int64_t kMinimum =
    std::int64_t{std::numeric_limits<std::int32_t>::min()} * (1 << kFractionBits);

// Modulo 2^64: partial sums may overflow, what counts is that the whole sum does not.
std::uint64_t multiply(Ratio coefficient, std::int64_t value) {
  return static_cast<std::uint64_t>(coefficient.raw() * value);
}

}  // namespace

void BiquadFilter::reset(std::int32_t value_raw) {
  input_1_ = input_2_ = value_raw;
  output_1_ = output_2_ = {.whole = value_raw};
}

std::int32_t BiquadFilter::filter(const BiquadCoefficients& c, std::int32_t input_raw) {
  const std::int64_t from_fractions = (std::int64_t{c.a1.raw()} * output_1_.fraction +
                                       std::int64_t{c.a2.raw()} * output_2_.fraction + kHalf) >>
                                      kFractionBits;
  const std::uint64_t from_outputs = static_cast<std::uint64_t>(from_fractions) +
                                     multiply(c.a1, output_1_.whole) + multiply(c.a2, output_2_.whole);
  const std::uint64_t from_inputs =
      multiply(c.b0, input_raw) + multiply(c.b1, input_1_) + multiply(c.b2, input_2_);
  const std::int64_t output =
      std::clamp(static_cast<std::int64_t>(from_inputs - from_outputs), kMinimum, kMaximum);

  input_2_ = input_1_;
  input_1_ = input_raw;
  output_2_ = output_1_;
  output_1_ = {.whole = static_cast<std::int32_t>(output >> kFractionBits),
               .fraction = static_cast<std::int32_t>(output) & kFractionMask};
  // Rounded; the largest has no fraction.
  return output_1_.whole + (output_1_.fraction >> (kFractionBits - 1));
}

}  // namespace koboshi::fixed
