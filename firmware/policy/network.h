#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/policy/activation.h"
#include "firmware/policy/rescale.h"

// A multilayer perceptron on integers: weights of 8 bits, activations of 16 bits, sums of 32 bits.
namespace koboshi::policy {

inline constexpr std::size_t kMaxWidth = 128;  // of a layer, and of the inputs
inline constexpr std::size_t kMaxLayers = 4;
// Rows and columns of a layer are multiples of this: the loops are unrolled by it.
inline constexpr std::size_t kBlock = 8;
inline constexpr std::size_t kRowsAtOnce = 4;
// |sum of products| <= 2^7 * 2^15 * kMaxWidth = 2^29, so that with a bias of less than this no sum overflows.
inline constexpr std::int32_t kMaxBias = 1 << 30;

[[nodiscard]] constexpr std::size_t padded(std::size_t size) { return (size + kBlock - 1) / kBlock * kBlock; }

// The activations of a layer, aligned so that two are loaded at once.
struct alignas(std::uint64_t) Activations {
  std::array<std::int16_t, kMaxWidth> values{};
};

// A layer: out = f(rescale(weights * in + biases, multiplier)). Its bytes are those of an image, at addresses
// that are multiples of 4.
//
// Weights come in blocks of four rows. A block has 8 bytes for each two columns c and c + 1: four int16 for
// (row r, r + 1; column c), (r, r + 1; c + 1), (r + 2, r + 3; c), (r + 2, r + 3; c + 1), little-endian. Each
// int16 holds the two weights of a column, 256 * w[r + 1] + w[r]. One multiplication of the whole number, and
// one of its low byte, give both products: that saves the unpacking of the high byte, and is what makes a
// product cost one instruction of the Cortex-M4. The pairs (SMLALD, SMLAD) need two columns in one register.
struct Layer {
  std::size_t columns = 0;  // a multiple of kBlock, at most kMaxWidth; as for rows
  std::size_t rows = 0;
  Activation activation = Activation::kLinear;
  int fraction_bits = kMaxFractionBits;  // of the pre-activations, where the function needs them
  std::int32_t multiplier = 0;
  const std::byte* biases = nullptr;   // int32, one a row, |bias| < kMaxBias
  const std::byte* weights = nullptr;  // rows * columns bytes

  // Computes the values of all rows from those of all columns.
  void run(const Activations& in, Activations& out) const;
};

// Returns the number that holds two weights of a column; |weight| <= 127.
[[nodiscard]] constexpr std::int16_t packed_weights(std::int8_t row, std::int8_t next_row) {
  return static_cast<std::int16_t>(256 * next_row + row);
}

}  // namespace koboshi::policy
