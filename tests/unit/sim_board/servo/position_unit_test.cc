#include "sim_board/servo/position_unit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>

namespace koboshi::sim_board {
namespace {

TEST(Nearest, IsTheRoundingOfTheStandardLibrary) {
  for (const double magnitude :
       {0.0, 0.25, 0.5, 1.0, 1.5, 2.5, 32767.5, 1e9, 0x1p51, 0x1p52, 0x1p53, 0x1p62}) {
    for (const double value : {magnitude, std::nextafter(magnitude, 0.0), std::nextafter(magnitude, 1e300)}) {
      EXPECT_EQ(nearest(value), std::llround(value)) << value;
      EXPECT_EQ(nearest(-value), std::llround(-value)) << value;
    }
  }
  constexpr std::uint64_t kSeed = 1;
  std::uint64_t bits = kSeed;
  for (int i = 0; i < 100'000; ++i) {
    bits = bits * 6364136223846793005u + 1442695040888963407u;
    const double value =
        std::ldexp(static_cast<double>(static_cast<std::int64_t>(bits)), -static_cast<int>(bits % 64));
    ASSERT_EQ(nearest(value), std::llround(value)) << "seed " << kSeed;
  }
}

}  // namespace
}  // namespace koboshi::sim_board
