#include "simulation/model/bus_load.h"

#include <gtest/gtest.h>

#include "sim_board/can/frame_bits.h"

namespace koboshi::simulation {
namespace {

// The figures of docs/design/timing.md.
TEST(BusLoad, OfTwentyDrives) {
  const BusLoad load = bus_load(20, false);
  EXPECT_NEAR(load.shortest, 0.508, 0.001);
  EXPECT_NEAR(load.longest, 0.616, 0.001);
  EXPECT_DOUBLE_EQ(load.frames_per_s, 5058.0);
}

TEST(BusLoad, OfSensorsOnTheBus) {
  const BusLoad own = bus_load(20, false);
  const BusLoad shared = bus_load(20, true);
  EXPECT_DOUBLE_EQ(shared.frames_per_s - own.frames_per_s, 930.0);
  EXPECT_NEAR(shared.longest - own.longest, 0.123, 0.001);
}

// Each drive adds a target and an answer to each cycle, and ten heartbeats a second.
TEST(BusLoad, OfOneMoreDrive) {
  const double longest = bus_load(21, false).longest - bus_load(20, false).longest;
  const int bits = sim_board::kMaxFrameBits + sim_board::kIntermissionBits;
  EXPECT_NEAR(longest, 1e-6 * (100 * (115 + bits) + 10 * 65), 1e-9);
}

TEST(BusLoad, LimitsTheNumberOfDrives) {
  EXPECT_LE(bus_load(31, false).longest, kMaxBusLoad);
  EXPECT_GT(bus_load(32, false).longest, kMaxBusLoad);
  EXPECT_LE(bus_load(26, true).longest, kMaxBusLoad);
  EXPECT_GT(bus_load(27, true).longest, kMaxBusLoad);
}

}  // namespace
}  // namespace koboshi::simulation
