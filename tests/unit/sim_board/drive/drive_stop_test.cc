#include <array>
#include <cmath>
#include <string>

#include "tests/support/random_frames.h"
#include "tests/unit/sim_board/drive/turning_drive.h"

// A stop ends within a second and within 0x607D, whatever the objects of its ramps hold.
namespace koboshi::sim_board {
namespace {

constexpr std::int32_t kStopRange = 120 * kDegree;
constexpr std::uint32_t kFlattestRamp = 1'000;

enum class StopCause : std::uint8_t {
  kQuickStop,
  kShutdown,
  kDisableOperation,
  kHalt,
  kHeartbeatLost,
  kSyncLost,
  kPreOperational,
};
constexpr StopCause kStopCauses[] = {
    StopCause::kQuickStop,     StopCause::kShutdown, StopCause::kDisableOperation, StopCause::kHalt,
    StopCause::kHeartbeatLost, StopCause::kSyncLost, StopCause::kPreOperational};

class StoppingDrive : public TurningDrive {
 protected:
  // Full speed upwards, in the profile mode or the cyclic one, from one end of the range.
  void enable_and_move(std::int8_t mode) {
    configure();
    write({0x6083, 0}, acceleration, 4);
    write_limits(-kStopRange, kStopRange);
    write({0x6060, 0}, static_cast<std::uint32_t>(mode), 1);
    target = position();
    for (const std::uint16_t word : kWayToOperation) {
      controlword = word;
      turn_ms(12);
    }
    ASSERT_EQ(drive->state(), State::kOperationEnabled);
    ASSERT_EQ(drive->values().mode_display, mode);
    if (mode == cia402::kProfilePosition) {
      target = kStopRange;
      controlword = cia402::kControlEnableOperation | cia402::kNewSetPoint;
      turn_ms(220);
      return;
    }
    stream_ms(220);
  }
  // With the master's targets of the cyclic mode, which go on.
  void stream_ms(int duration_ms) {
    for (int ms = 0; ms < duration_ms; ++ms) {
      const bool cyclic = drive->values().mode_display == cia402::kCyclicSynchronousPosition;
      if (cyclic && now_us % kCycle_us == 0) target = std::min(target + 12'000, kStopRange);  // 7.2 rad/s
      turn_ms(1);
      was_limited = was_limited || limited();
      ASSERT_LE(position(), kStopRange + kDegree);
    }
  }
  void bring_about(StopCause cause) {
    switch (cause) {
      case StopCause::kQuickStop:
        controlword = cia402::kControlQuickStop;
        return;
      case StopCause::kShutdown:
        controlword = cia402::kControlShutdown;
        return;
      case StopCause::kDisableOperation:
        controlword = cia402::kControlSwitchOn;
        return;
      case StopCause::kHalt:
        controlword = cia402::kControlEnableOperation | cia402::kNewSetPoint | cia402::kHalt;
        return;
      case StopCause::kHeartbeatLost:
        heartbeats = false;
        stream_ms(60);
        syncs = false;  // nor anything else of a master that is gone
        return;
      case StopCause::kSyncLost:
        syncs = false;
        stream_ms(50);
        return;
      case StopCause::kPreOperational:
        say({.identifier = 0x000, .size = 2, .data = {0x80, kNode}});
        return;
    }
  }
  void expect_rest_within_a_second(StopCause cause) {
    stream_ms(1'000);
    EXPECT_NEAR(speed_units_per_s(), 0.0, kDegree);
    if (cause != StopCause::kHalt) {
      EXPECT_NE(drive->state(), State::kOperationEnabled);
      EXPECT_NE(drive->state(), State::kFaultReactionActive);
    }
    const std::int32_t rest = position();
    turn_ms(200);
    EXPECT_NEAR(position(), rest, kDegree / 2);
  }
  void use_slow_down_ramps() {
    write({0x605A, 0}, 1, 2);
    write({0x605B, 0}, 1, 2);
    write({0x605C, 0}, 1, 2);
    write({0x605D, 0}, 1, 2);
    write({0x605E, 0}, 1, 2);
  }

  std::uint32_t acceleration = 20'000'000;
  bool was_limited = false;
};

// The ramp is as flat as an SDO client may make it.
class FlatRamp : public StoppingDrive, public testing::WithParamInterface<StopCause> {};

TEST_P(FlatRamp, IsSteepenedAndSaysSo) {
  use_slow_down_ramps();
  place(-kStopRange);
  for (const std::int8_t mode : {cia402::kCyclicSynchronousPosition, cia402::kProfilePosition}) {
    if (GetParam() == StopCause::kHalt && mode != cia402::kProfilePosition) continue;
    SCOPED_TRACE(int{mode});
    enable_and_move(mode);
    ASSERT_GT(speed_units_per_s(), 300 * kDegree);
    ASSERT_EQ(abort_of({0x6084, 0}, kFlattestRamp, 4), 0u);
    stream_ms(30);
    was_limited = false;
    bring_about(GetParam());
    expect_rest_within_a_second(GetParam());
    // Without SYNC there are no targets, and the demand stands before the drive misses it.
    EXPECT_EQ(was_limited, GetParam() != StopCause::kSyncLost || mode == cia402::kProfilePosition);
    EXPECT_FALSE(limited());
    reset_node();
    use_slow_down_ramps();
    place(-kStopRange);
  }
}

std::string stop_cause_name(const testing::TestParamInfo<StopCause>& info) {
  constexpr const char* kNames[] = {"QuickStop",     "Shutdown", "DisableOperation", "Halt",
                                    "HeartbeatLost", "SyncLost", "PreOperational"};
  return kNames[static_cast<int>(info.param)];
}
INSTANTIATE_TEST_SUITE_P(Drive, FlatRamp, testing::ValuesIn(kStopCauses), stop_cause_name);

TEST_F(StoppingDrive, KeepsARampThatIsSteepEnough) {
  write({0x605A, 0}, 6, 2);
  write({0x6085, 0}, 3'000'000, 4);
  place(-kStopRange);
  enable_and_move(cia402::kProfilePosition);
  const double speed = speed_units_per_s();
  controlword = cia402::kControlQuickStop;
  while (drive->state() == State::kOperationEnabled) turn_ms(1);
  const std::int32_t start = drive->values().position_demand;
  was_limited = false;
  stream_ms(1'000);
  EXPECT_FALSE(was_limited);
  EXPECT_NEAR(drive->values().position_demand - start, 0.5 * speed * speed / 3e6, 0.1 * speed * speed / 3e6);
}

// The demand may be far ahead of the shaft: it arrives at once where the profile's velocity allows it.
TEST_F(StoppingDrive, StopsItsShaftAndNotItsDemand) {
  write({0x605A, 0}, 6, 2);
  write({0x6080, 0}, 100'000, 4);
  write({0x6081, 0}, 0x7FFF'FFFF, 4);
  acceleration = 0x7FFF'FFFF;
  write({0x6084, 0}, 0x7FFF'FFFF, 4);
  place(-kStopRange);
  enable_and_move(cia402::kProfilePosition);
  ASSERT_EQ(drive->values().position_demand, kStopRange);
  ASSERT_LT(position(), 0);
  controlword = cia402::kControlQuickStop;
  turn_ms(200);
  EXPECT_LT(position(), 30 * kDegree);
  EXPECT_NEAR(speed_units_per_s(), 0.0, kDegree);
}

// A set-point behind a drive in full motion, which has to brake first.
TEST_F(StoppingDrive, TurnsBackWithinItsLimits) {
  place(-kStopRange);
  enable_and_move(cia402::kProfilePosition);
  ASSERT_EQ(abort_of({0x6084, 0}, kFlattestRamp, 4), 0u);
  ASSERT_EQ(abort_of({0x60C5, 0}, kFlattestRamp, 4), 0u);
  controlword = cia402::kControlEnableOperation;
  turn_ms(12);
  target = -kStopRange;
  controlword = cia402::kControlEnableOperation | cia402::kNewSetPoint | cia402::kChangeImmediately;
  stream_ms(2'000);
  EXPECT_TRUE(was_limited);
}

// Two causes in a row make no longer stop than one.
TEST_F(StoppingDrive, DoesNotBeginAnewForASecondStopCause) {
  use_slow_down_ramps();
  place(-kStopRange);
  enable_and_move(cia402::kProfilePosition);
  ASSERT_EQ(abort_of({0x6084, 0}, kFlattestRamp, 4), 0u);
  controlword = cia402::kControlQuickStop;
  turn_ms(400);
  ASSERT_EQ(drive->state(), State::kQuickStopActive);
  say({.identifier = 0x000, .size = 2, .data = {0x80, kNode}});
  turn_ms(600);
  EXPECT_EQ(drive->state(), State::kFault);
  EXPECT_NEAR(speed_units_per_s(), 0.0, kDegree);
}

// Random contents of every object of the ramps and limits, random speeds, every cause and option.
TEST_F(StoppingDrive, EndsInTimeForRandomObjects) {
  test::Random random(20261125);
  const auto magnitude = [&](std::uint32_t low, std::uint32_t high) {
    const double share = random.next() / 4'294'967'296.0;
    return static_cast<std::uint32_t>(low * std::pow(static_cast<double>(high) / low, share));
  };
  for (int trial = 0; trial < 150; ++trial) {
    SCOPED_TRACE(trial);
    reset_node();
    place(-kStopRange);
    write({0x605A, 0}, 1 + random.below(8), 2);
    write({0x605B, 0}, 1, 2);
    write({0x605C, 0}, 1, 2);
    write({0x605D, 0}, 1 + random.below(2), 2);
    write({0x605E, 0}, 1 + random.below(2), 2);
    write({0x6007, 0}, random.below(2) == 0 ? 1 : 3, 2);
    write({0x2001, 0}, random.next(), 4);
    const std::int8_t mode =
        random.below(2) == 0 ? cia402::kProfilePosition : cia402::kCyclicSynchronousPosition;
    enable_and_move(mode);
    const StopCause cause = random.one_of(kStopCauses);
    if (cause == StopCause::kHalt && mode != cia402::kProfilePosition) continue;
    stream_ms(static_cast<int>(random.below(250)));
    if (random.below(2) == 0) write({0x6080, 0}, magnitude(1, 100'000), 4);
    if (random.below(2) == 0) write({0x60C5, 0}, magnitude(1'000, 0x7FFF'FFFF), 4);
    write({0x6081, 0}, magnitude(1, 0x7FFF'FFFF), 4);
    write({0x6083, 0}, magnitude(1'000, 0x7FFF'FFFF), 4);
    write({0x6084, 0}, magnitude(1'000, 0x7FFF'FFFF), 4);
    write({0x6085, 0}, magnitude(1'000, 0x7FFF'FFFF), 4);
    bring_about(cause);
    stream_ms(1'000);
    ASSERT_NEAR(speed_units_per_s(), 0.0, kDegree);
  }
}

}  // namespace
}  // namespace koboshi::sim_board
