#include "firmware/policy/network.h"

#include <array>
#include <cstring>

#include "firmware/fixed/contract.h"

namespace koboshi::policy {
namespace {

constexpr std::size_t kAlignment = sizeof(std::uint32_t);

inline std::uint32_t word_at(const void* aligned) {
  std::uint32_t word = 0;
  std::memcpy(&word, __builtin_assume_aligned(aligned, kAlignment), sizeof(word));
  return word;
}

// Sums of products of four rows, in pairs: `wide` of the packed weights, `low` of their low bytes.
struct Sums {
  std::int64_t wide_01 = 0;
  std::int64_t wide_23 = 0;
  std::int32_t low_01 = 0;
  std::int32_t low_23 = 0;
};

#ifdef __ARM_FEATURE_DSP

// The products of two columns, which the register `in` has, with a block of four rows.
#define KOBOSHI_TWO_COLUMNS(in)                  \
  "ldrd %[w], %[v], [%[weight]], #8\n\t"         \
  "smlald %Q[wide_01], %R[wide_01], %[w], %[" in \
  "]\n\t"                                        \
  "sxtb16 %[w], %[w]\n\t"                        \
  "smlad %[low_01], %[w], %[" in                 \
  "], %[low_01]\n\t"                             \
  "smlald %Q[wide_23], %R[wide_23], %[v], %[" in \
  "]\n\t"                                        \
  "sxtb16 %[v], %[v]\n\t"                        \
  "smlad %[low_23], %[v], %[" in "], %[low_23]\n\t"

#define KOBOSHI_FOUR_COLUMNS \
  "ldrd %[a], %[b], [%[column]], #8\n\t" KOBOSHI_TWO_COLUMNS("a") KOBOSHI_TWO_COLUMNS("b")

// Adds the products of a block with all columns; returns its end. 32 instructions for 32 products. GCC 12
// needs 52 for the same by intrinsics: it moves the pairs of registers about (27 November 2026).
inline const std::byte* add_products(const std::byte* weight, const std::int16_t* column,
                                     const std::int16_t* end, Sums& sums) {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  std::uint32_t w = 0;
  std::uint32_t v = 0;
  asm volatile("0:\n\t" KOBOSHI_FOUR_COLUMNS KOBOSHI_FOUR_COLUMNS
               "cmp %[column], %[end]\n\t"
               "bne 0b"
               : [weight] "+&r"(weight), [column] "+&r"(column), [wide_01] "+&r"(sums.wide_01),
                 [wide_23] "+&r"(sums.wide_23), [low_01] "+&r"(sums.low_01), [low_23] "+&r"(sums.low_23),
                 [a] "=&r"(a), [b] "=&r"(b), [w] "=&r"(w), [v] "=&r"(v)
               : [end] "r"(end)
               : "cc", "memory");
  return weight;
}

#undef KOBOSHI_FOUR_COLUMNS
#undef KOBOSHI_TWO_COLUMNS

#else

// The same on any core.
inline void add_products(std::uint32_t weights, std::uint32_t in, std::int64_t& wide, std::int32_t& low) {
  for (const int bit : {0, 16}) {
    const auto packed = static_cast<std::int16_t>(weights >> bit);
    const auto a = static_cast<std::int16_t>(in >> bit);
    wide += std::int64_t{packed} * a;
    low += std::int32_t{static_cast<std::int8_t>(weights >> bit)} * a;
  }
}

inline const std::byte* add_products(const std::byte* weight, const std::int16_t* column,
                                     const std::int16_t* end, Sums& sums) {
  for (; column != end; column += 2) {
    const std::uint32_t in =
        static_cast<std::uint16_t>(column[0]) | std::uint32_t{static_cast<std::uint16_t>(column[1])} << 16;
    add_products(word_at(weight), in, sums.wide_01, sums.low_01);
    add_products(word_at(weight + 4), in, sums.wide_23, sums.low_23);
    weight += 8;
  }
  return weight;
}

#endif

// The sum of the high weights: the difference is 256 times it, exactly.
inline std::int32_t high_sum(std::int64_t wide, std::int32_t low) {
  return static_cast<std::int32_t>((wide - low) >> 8);
}

inline std::int32_t bias_at(const std::byte* aligned) { return static_cast<std::int32_t>(word_at(aligned)); }

using RowSums = std::array<std::int32_t, kMaxWidth>;

void multiply(const Layer& layer, const Activations& in, RowSums& sums) {
  const std::byte* weight = layer.weights;
  const std::int16_t* const begin = in.values.data();
  const std::int16_t* const end = begin + layer.columns;
  std::int32_t* const last = sums.data() + layer.rows;
  for (std::int32_t* row = sums.data(); row != last; row += kRowsAtOnce) {
    Sums block;
    weight = add_products(weight, begin, end, block);
    row[0] = block.low_01;
    row[1] = high_sum(block.wide_01, block.low_01);
    row[2] = block.low_23;
    row[3] = high_sum(block.wide_23, block.low_23);
  }
}

// A loop of its own has all of its constants in registers: that takes several instructions less for each row
// than within the loop over the blocks.
template <Activation kActivation, bool kWidens>
void finish(const Layer& layer, const RowSums& sums, Activations& out) {
  const ActivationFunction<kActivation, kWidens> function(layer.fraction_bits);
  const std::int32_t multiplier = layer.multiplier;
  const std::byte* bias = layer.biases;
  std::int16_t* value = out.values.data();
  const std::int32_t* const last = sums.data() + layer.rows;
  for (const std::int32_t* sum = sums.data(); sum != last; bias += sizeof(std::int32_t))
    *value++ = static_cast<std::int16_t>(function(rescale(*sum++ + bias_at(bias), multiplier)));
}

// The usual range has a loop of its own, without the shifts.
template <Activation kActivation>
void finish(const Layer& layer, const RowSums& sums, Activations& out) {
  if (layer.fraction_bits == kMaxFractionBits) return finish<kActivation, false>(layer, sums, out);
  finish<kActivation, true>(layer, sums, out);
}

}  // namespace

void Layer::run(const Activations& in, Activations& out) const {
  KOBOSHI_ASSERT(rows > 0 && rows <= kMaxWidth && rows % kBlock == 0);
  KOBOSHI_ASSERT(columns > 0 && columns <= kMaxWidth && columns % kBlock == 0);
  KOBOSHI_ASSERT(fraction_bits >= kMinFractionBits && fraction_bits <= kMaxFractionBits);
  RowSums sums;  // not cleared
  multiply(*this, in, sums);
  switch (activation) {
    case Activation::kLinear:
      return finish<Activation::kLinear, false>(*this, sums, out);
    case Activation::kRelu:
      return finish<Activation::kRelu, false>(*this, sums, out);
    case Activation::kElu:
      return finish<Activation::kElu>(*this, sums, out);
    case Activation::kTanh:
      return finish<Activation::kTanh>(*this, sums, out);
    case Activation::kSilu:
      return finish<Activation::kSilu>(*this, sums, out);
  }
}

}  // namespace koboshi::policy
