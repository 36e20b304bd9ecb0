#include "simulation/record/state_hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace koboshi::simulation {
namespace {

// Values of the reference implementation: XXH3_64bits of nothing, and of the bytes 01 02 03 04 05 06 07 08.
TEST(StateHash, EqualsXxh3OfTheBytes) {
  StateHash hash;
  EXPECT_EQ(hash.hex(), "2d06800538d394c2");
  hash.add(std::uint32_t{0x04030201});
  hash.add(std::uint32_t{0x08070605});
  constexpr std::uint8_t kBytes[] = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(hash.value(), XXH3_64bits(kBytes, sizeof(kBytes)));
  StateHash whole;
  whole.add(std::uint64_t{0x0807060504030201});
  EXPECT_EQ(whole.hex(), hash.hex());
}

TEST(StateHash, IsTheSameHoweverTheBytesAreDivided) {
  std::vector<std::byte> bytes(5000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * i >> 3);
  const std::uint64_t expected = XXH3_64bits(bytes.data(), bytes.size());
  for (const std::size_t part : {1u, 7u, 8u, 1000u, 1024u, 1025u, 5000u}) {
    StateHash hash;
    for (std::size_t i = 0; i < bytes.size(); i += part)
      hash.add(std::span<const std::byte>(bytes).subspan(i, std::min(part, bytes.size() - i)));
    EXPECT_EQ(hash.value(), expected) << part;
    const StateHash copy(hash);
    EXPECT_EQ(copy.value(), expected) << part;
  }
}

TEST(StateHash, HashesTheBitsOfDoubles) {
  StateHash number, bits, negative_zero, zero;
  number.add(1.0);
  bits.add(std::uint64_t{0x3FF0000000000000});
  negative_zero.add(-0.0);
  zero.add(0.0);
  EXPECT_EQ(number.value(), bits.value());
  EXPECT_NE(negative_zero.value(), zero.value());
}

TEST(StateHash, DependsOnOrderAndWidth) {
  StateHash ab, ba, wide;
  ab.add(std::int16_t{-1});
  ab.add(std::uint8_t{0});
  ba.add(std::uint8_t{0});
  ba.add(std::int16_t{-1});
  wide.add(std::int32_t{0xFFFF});
  EXPECT_NE(ab.value(), ba.value());
  EXPECT_NE(ab.value(), wide.value());
}

TEST(StateHash, ContinuesAfterADigest) {
  StateHash looked, other;
  looked.add(std::uint64_t{1});
  other.add(std::uint64_t{1});
  (void)looked.value();
  for (std::uint64_t i = 0; i < 1000; ++i) {
    looked.add(i);
    other.add(i);
  }
  EXPECT_EQ(looked.hex(), other.hex());
}

}  // namespace
}  // namespace koboshi::simulation
