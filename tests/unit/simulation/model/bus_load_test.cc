#include "simulation/model/bus_load.h"

#include <gtest/gtest.h>

#include "sim_board/can/frame_bits.h"

namespace koboshi::simulation {
namespace {

// The figures of docs/design/timing.md.
TEST(BusLoad, OfTwentyDrives) {
  const BusLoad load = bus_load(20, false);
  EXPECT_NEAR(load.shortest, 0.522, 0.001);
  EXPECT_NEAR(load.longest, 0.633, 0.001);
  EXPECT_DOUBLE_EQ(load.frames_per_s, 5178.0);
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

// A set of 20 targets is five full frames and the counter.
TEST(StreamLoad, OfTwentyDrives) {
  const BusLoad load = stream_load(20, 100.0);
  EXPECT_NEAR(load.longest, 0.074, 0.0001);
  EXPECT_DOUBLE_EQ(load.frames_per_s, 600.0);
  EXPECT_DOUBLE_EQ(stream_load(21, 50.0).frames_per_s, 350.0);
}

// The table of docs/design/timing.md.
TEST(StreamLoad, LimitsTheRateOfSets) {
  EXPECT_DOUBLE_EQ(max_stream_rate_Hz(22, true), 100.0);
  EXPECT_DOUBLE_EQ(max_stream_rate_Hz(23, true), 50.0);
  EXPECT_NEAR(max_stream_rate_Hz(24, true), 33.3, 0.1);
  EXPECT_NEAR(max_stream_rate_Hz(25, true), 14.3, 0.1);
  EXPECT_DOUBLE_EQ(max_stream_rate_Hz(26, true), 0.0);
  EXPECT_DOUBLE_EQ(max_stream_rate_Hz(27, false), 100.0);
  EXPECT_DOUBLE_EQ(max_stream_rate_Hz(28, false), 50.0);
  EXPECT_NEAR(max_stream_rate_Hz(29, false), 33.3, 0.1);
  EXPECT_DOUBLE_EQ(max_stream_rate_Hz(30, false), 20.0);
  EXPECT_DOUBLE_EQ(max_stream_rate_Hz(31, false), 0.0);
}

}  // namespace
}  // namespace koboshi::simulation
