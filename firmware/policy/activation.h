#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/policy/rescale.h"

// The activation functions of a network, from integers to integers.
namespace koboshi::policy {

// The activation function of a layer. The values are those of the image.
enum class Activation : std::uint8_t {
  kLinear = 0,
  kRelu = 1,
  kElu = 2,  // z above 0, e^z - 1 below
  kTanh = 3,
  kSilu = 4,  // z / (1 + e^-z)
};
inline constexpr auto kLastActivation = Activation::kSilu;

// Fraction bits of a pre-activation z: at least 8, at most 12, which is a range of +-128 to +-8.
inline constexpr int kMinFractionBits = 8;
inline constexpr int kMaxFractionBits = 12;
// Fraction bits of the values of tanh.
inline constexpr int kTanhFractionBits = 15;

// A function's values over [-8, 8) in units of 2^-kTanhFractionBits, with 32 entries per unit: the value in
// the lower half of an entry, the difference to the next one in the upper half.
inline constexpr int kStepBits = 5;
inline constexpr int kTableZero = 8 << kStepBits;  // the entry of zero
using FunctionTable = std::array<std::int32_t, 2 * kTableZero>;
extern const FunctionTable kTanhTable;
extern const FunctionTable kSigmoidTable;  // 1 / (1 + e^-x)
extern const FunctionTable kExpTable;      // e^x - 1 up to zero, and 0 beyond

// Returns the function at z, in units of 2^-kMaxFractionBits: -8 to 8.
[[nodiscard]] inline std::int32_t interpolate(const FunctionTable& table, std::int32_t z) {
  constexpr int kBits = kMaxFractionBits - kStepBits;
  const std::int32_t* const zero = table.data() + kTableZero;
  const std::int32_t entry = zero[z >> kBits];
  const std::int32_t rest = z & ((1 << kBits) - 1);
#ifdef __ARM_FEATURE_DSP
  // One instruction, which GCC 12 does not find.
  const std::int32_t step = __builtin_arm_smlatb(entry, rest, 1 << (kBits - 1));
#else
  const std::int32_t step = (entry >> 16) * rest + (1 << (kBits - 1));
#endif
  return static_cast<std::int16_t>(entry) + (step >> kBits);
}

// An activation function: from pre-activations in units of 2^-fraction_bits, within the range of an int16, to
// values in units of 2^-kTanhFractionBits for tanh, else in the same units. Errors over all 2^16 arguments,
// in units of the result: 3.8 for tanh, 1.2 for SiLU, 1.1 for ELU
// (tests/unit/firmware/policy/activation_test.cc). `kWidens`: fraction_bits is less than kMaxFractionBits;
// tanh, the sigmoid of SiLU and the exponential of ELU then saturate their argument at +-8.
template <Activation kActivation, bool kWidens>
class ActivationFunction {
 public:
  explicit ActivationFunction(int fraction_bits)
      : missing_bits_(kMaxFractionBits - fraction_bits), elu_shift_(kTanhFractionBits - fraction_bits) {}

  [[nodiscard]] std::int32_t operator()(std::int32_t z) const {
    if constexpr (kActivation == Activation::kRelu) return z < 0 ? 0 : z;
    if constexpr (kActivation == Activation::kElu) {
      if (z >= 0) return z;
      return (interpolate(kExpTable, widened(z)) + (1 << elu_shift() >> 1)) >> elu_shift();
    }
    if constexpr (kActivation == Activation::kTanh) return interpolate(kTanhTable, widened(z));
    if constexpr (kActivation == Activation::kSilu)
      return (z * interpolate(kSigmoidTable, widened(z)) + (1 << kTanhFractionBits >> 1)) >>
             kTanhFractionBits;
    return z;
  }

 private:
  // In units of 2^-kMaxFractionBits.
  [[nodiscard]] std::int32_t widened(std::int32_t z) const {
    return kWidens ? saturate16(z << missing_bits_) : z;
  }
  [[nodiscard]] int elu_shift() const { return kWidens ? elu_shift_ : kTanhFractionBits - kMaxFractionBits; }

  int missing_bits_;
  int elu_shift_;
};

}  // namespace koboshi::policy
