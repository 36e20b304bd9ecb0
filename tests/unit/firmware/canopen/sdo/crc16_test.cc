#include "firmware/canopen/sdo/protocol.h"

#include <gtest/gtest.h>

#include <array>

namespace koboshi::canopen {
namespace {

constexpr std::array<std::uint8_t, 9> kCheck{'1', '2', '3', '4', '5', '6', '7', '8', '9'};

// The check value of CiA 301, 7.2.4.3.16.
TEST(Crc16, GivesTheCheckValueOfTheStandard) {
  static_assert(crc16(0, kCheck) == 0x31C3);
  EXPECT_EQ(crc16(0, {}), 0);
}

TEST(Crc16, ContinuesIncrementally) {
  const std::span<const std::uint8_t> all(kCheck);
  for (std::size_t cut = 0; cut <= all.size(); ++cut) {
    EXPECT_EQ(crc16(crc16(0, all.first(cut)), all.subspan(cut)), 0x31C3);
  }
}

}  // namespace
}  // namespace koboshi::canopen
