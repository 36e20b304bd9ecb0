// The joint target stream (docs/decision/0041): commands, sets by PDO and SDO, its deadline, limits and
// falls.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "firmware/canopen/frame.h"
#include "tests/support/controller_bench.h"
#include "tests/support/sdo_pc.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;

constexpr std::uint16_t kStreamEmergency = 0x081;
constexpr std::uint16_t kTimeout = 0x8250;
constexpr std::int16_t kUnits_per_deg = (1 << 16) / 360;

double degrees(fixed::Angle angle) { return 360.0 * static_cast<double>(angle.raw()) / 4294967296.0; }

class JointStreamBench : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(bench.run_until_ready_to_walk());
    for (std::size_t joint = 0; joint < bench.model().joint_count; ++joint)
      standing.push_back(bench.target(joint));
  }

  // Sends targets in 2^-16 turn for joints 4 `group` to 4 `group` + 3.
  void send_targets(std::size_t group, const std::array<std::int16_t, 4>& targets) {
    hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(kStreamTargetBase + group), .size = 8};
    const std::size_t joints = std::min<std::size_t>(4, bench.model().joint_count - 4 * group);
    frame.size = static_cast<std::uint8_t>(2 * joints);
    for (std::size_t i = 0; i < joints; ++i)
      canopen::store_u16(&frame.data[2 * i], static_cast<std::uint16_t>(targets[i]));
    bench.board.can.deliver(frame);
  }
  void send_sequence(int number) {
    hal::CanFrame frame{.identifier = kStreamSequenceIdentifier, .size = 1};
    frame.data[0] = static_cast<std::uint8_t>(number);
    bench.board.can.deliver(frame);
  }
  // One set in each cycle: `raw` for the first four joints.
  void stream(const std::array<std::int16_t, 4>& raw, int cycles) {
    for (int cycle = 0; cycle < cycles; ++cycle) {
      send_targets(0, raw);
      send_sequence(sequence++);
      bench.run_ms(10);
    }
  }
  void begin() {
    bench.command(Command::kStream);
    bench.run_ms(11);
    ASSERT_EQ(bench.now().state, State::kStreaming);
    ASSERT_EQ(bench.now().refusal, Reason::kNone);
  }
  std::vector<int> emergencies() const {
    std::vector<int> codes;
    for (const auto& [time_us, frame] : bench.sent)
      if (frame.identifier == kStreamEmergency) codes.push_back(canopen::load_u16(frame.data.data()));
    return codes;
  }
  const auto& values() const { return bench.values().stream; }

  ControllerBench bench;
  test::SdoPc pc{bench};
  std::vector<fixed::Angle> standing;
  int sequence = 0;
};

TEST_F(JointStreamBench, FollowsTheTargetsOfEachSet) {
  begin();
  const std::array<std::int16_t, 4> raw{5 * kUnits_per_deg, -3 * kUnits_per_deg, 2 * kUnits_per_deg,
                                        4 * kUnits_per_deg};
  stream(raw, 50);
  for (std::size_t joint = 0; joint < 4; ++joint) {
    const fixed::Angle wanted = robot::clamp_to_limits(
        bench.model().joints[joint], fixed::Angle::from_raw(std::int32_t{raw[joint]} * 65536));
    EXPECT_NEAR(degrees(bench.target(joint)), degrees(wanted), 0.001) << joint;
  }
  EXPECT_EQ(values().taken_sets, 50);
  EXPECT_EQ(values().missing_sets, 0);
  // The set had the joints of one PDO only: the others stay, but for the rounding to 2^-16 turn.
  for (std::size_t joint = 4; joint < standing.size(); ++joint)
    EXPECT_NEAR(degrees(bench.target(joint)), degrees(standing[joint]), 0.003) << joint;
}

TEST_F(JointStreamBench, TakesTargetsWithTheSequenceCounterOnly) {
  begin();
  send_targets(0, {8 * kUnits_per_deg, 0, 0, 0});
  bench.run_ms(50);
  EXPECT_EQ(bench.target(0), standing[0]);
  send_sequence(1);
  bench.run_ms(20);
  EXPECT_NE(bench.target(0), standing[0]);
}

TEST_F(JointStreamBench, MovesAtTheHighestSpeedOfTheJoint) {
  begin();
  const double most_deg =
      360.0 * static_cast<double>(bench.model().joints[0].max_speed.raw()) / (1 << 24) / 100;
  double last = degrees(bench.target(0));
  double fastest = 0;
  for (int cycle = 0; cycle < 40; ++cycle) {
    stream({cycle < 20 ? std::int16_t{16'000} : std::int16_t{-16'000}, 0, 0, 0}, 1);
    const double now = degrees(bench.target(0));
    fastest = std::max(fastest, std::abs(now - last));
    last = now;
  }
  EXPECT_LE(fastest, most_deg + 0.001);
  EXPECT_GT(fastest, 0.9 * most_deg);
}

TEST_F(JointStreamBench, StaysWithinTheLimitsOfTheJoint) {
  begin();
  stream({32'767, 32'767, 32'767, 32'767}, 300);
  for (std::size_t joint = 0; joint < 4; ++joint)
    EXPECT_NEAR(degrees(bench.target(joint)), degrees(bench.model().joints[joint].upper), 0.01) << joint;
  stream({-32'768, -32'768, -32'768, -32'768}, 300);
  for (std::size_t joint = 0; joint < 4; ++joint)
    EXPECT_NEAR(degrees(bench.target(joint)), degrees(bench.model().joints[joint].lower), 0.01) << joint;
}

TEST_F(JointStreamBench, HoldsAndThenReturnsToStandingWithoutSets) {
  begin();
  stream({6 * kUnits_per_deg, 0, 0, 0}, 30);
  const fixed::Angle held = bench.target(0);
  bench.run_ms(kStreamDeadline_ms - 20);
  EXPECT_EQ(bench.target(0), held);
  EXPECT_TRUE(emergencies().empty());
  bench.run_ms(30);
  EXPECT_EQ(emergencies(), std::vector<int>{kTimeout});
  EXPECT_EQ(bench.now().state, State::kStreaming);  // it returns
  ASSERT_TRUE(bench.run_until(State::kStanding, 3'000));
  for (std::size_t joint = 0; joint < standing.size(); ++joint)
    EXPECT_EQ(bench.target(joint), standing[joint]);
  bench.run_ms(1'000);
  EXPECT_EQ(emergencies(), std::vector<int>{kTimeout});  // once
}

TEST_F(JointStreamBench, EndsWithoutAnySet) {
  begin();
  bench.run_ms(kStreamDeadline_ms + 10);
  EXPECT_EQ(emergencies(), std::vector<int>{kTimeout});
  EXPECT_TRUE(bench.run_until(State::kStanding, 3'000));
}

TEST_F(JointStreamBench, EndsByCommand) {
  begin();
  stream({6 * kUnits_per_deg, 0, 0, 0}, 30);
  bench.command(Command::kStop);
  stream({6 * kUnits_per_deg, 0, 0, 0}, 3);  // late sets change nothing
  ASSERT_TRUE(bench.run_until(State::kStanding, 3'000));
  EXPECT_EQ(bench.target(0), standing[0]);
  EXPECT_EQ(values().taken_sets, 30);
  EXPECT_TRUE(emergencies().empty());
}

TEST_F(JointStreamBench, GoesOnByCommandDuringTheReturn) {
  begin();
  stream({6 * kUnits_per_deg, 0, 0, 0}, 30);
  bench.command(Command::kStop);
  bench.run_ms(100);
  bench.command(Command::kStream);
  const fixed::Angle there = bench.target(0);
  stream({6 * kUnits_per_deg, 0, 0, 0}, 60);
  EXPECT_EQ(bench.now().state, State::kStreaming);
  EXPECT_GT(bench.target(0), there);
  EXPECT_NEAR(degrees(bench.target(0)), 6, 0.05);
}

TEST_F(JointStreamBench, CountsMissingSets) {
  begin();
  for (const int number : {7, 8, 11, 255, 0, 1, 3}) {
    send_sequence(number);
    bench.run_ms(10);
  }
  EXPECT_EQ(values().taken_sets, 7);
  EXPECT_EQ(values().missing_sets, 2 + 243 + 1);
}

TEST_F(JointStreamBench, CountsNoMissingSetForARepeatedCounter) {
  begin();
  for (const int number : {7, 7, 8, 8, 8, 200, 200, 201, 201}) {
    send_sequence(number);
    bench.run_ms(10);
  }
  EXPECT_EQ(values().taken_sets, 9);
  EXPECT_EQ(values().missing_sets, 191);  // 9 to 199
}

// The gap before a late set stays counted, and the sets after it count from the highest counter.
TEST_F(JointStreamBench, CountsNoMissingSetForALateOne) {
  begin();
  for (const int number : {254, 255, 1, 0, 2, 3, 249, 4}) {
    send_sequence(number);
    bench.run_ms(10);
  }
  EXPECT_EQ(values().taken_sets, 8);
  EXPECT_EQ(values().missing_sets, 1);
  send_sequence(249);  // 11 behind: 244 sets were skipped
  bench.run_ms(10);
  EXPECT_EQ(values().missing_sets, 1 + 244);
}

TEST_F(JointStreamBench, TakesSetsBySdo) {
  ASSERT_EQ(pc.write({kStreamObject, 1}, 1, 1), canopen::AbortCode::kDeviceState);
  ASSERT_EQ(pc.write({kRequestObject, 1}, static_cast<int>(Command::kStream), 1), canopen::AbortCode::kNone);
  ASSERT_EQ(pc.write({kStreamTargetObject, 1}, 3 * kUnits_per_deg, 2), canopen::AbortCode::kNone);
  for (int number = 0; number < 20; ++number) {
    ASSERT_EQ(pc.write({kStreamObject, 1}, number, 1), canopen::AbortCode::kNone);
    bench.run_ms(kStreamDeadline_ms - 30);
  }
  EXPECT_EQ(bench.now().state, State::kStreaming);
  EXPECT_NEAR(degrees(bench.target(0)), 3, 0.05);
  EXPECT_TRUE(emergencies().empty());
  bench.run_ms(kStreamDeadline_ms);
  EXPECT_EQ(emergencies(), std::vector<int>{kTimeout});
}

TEST_F(JointStreamBench, LimitsTorquesUntilItEnds) {
  begin();
  hal::CanFrame frame{.identifier = kStreamTorqueBase, .size = 8};
  frame.data = {40, 0, 100, 200, 0, 0, 0, 0};
  bench.board.can.deliver(frame);
  stream({}, 60);
  constexpr std::uint16_t kMaxTorque = 0x6072;
  const auto limit = [&](std::size_t drive) { return bench.drives[drive].object(kMaxTorque, 0); };
  const auto full = limit(1);
  EXPECT_EQ(10 * limit(0), 4 * full);
  EXPECT_EQ(limit(2), full);
  EXPECT_EQ(limit(3), full);
  bench.command(Command::kStop);
  ASSERT_TRUE(bench.run_until(State::kStanding, 3'000));
  bench.run_ms(300);
  EXPECT_EQ(limit(0), full);
}

TEST_F(JointStreamBench, IsRefusedWhileTheRobotMoves) {
  bench.command(Command::kPlay, 1);
  ASSERT_TRUE(bench.run_until(State::kMotion));
  bench.command(Command::kStream);
  bench.run_ms(20);
  EXPECT_EQ(bench.now().state, State::kMotion);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
}

TEST_F(JointStreamBench, RefusesMotionsAndWalksMeanwhile) {
  begin();
  bench.command(Command::kPlay, 1);
  stream({}, 2);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
  bench.command(Command::kWalk);
  stream({}, 2);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
  EXPECT_EQ(bench.now().state, State::kStreaming);
}

TEST_F(JointStreamBench, GoesLimpByCommandAndIgnoresSetsThen) {
  begin();
  stream({6 * kUnits_per_deg, 0, 0, 0}, 10);
  bench.command(Command::kLimp);
  stream({6 * kUnits_per_deg, 0, 0, 0}, 10);
  EXPECT_EQ(bench.now().state, State::kLimp);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
  EXPECT_EQ(values().taken_sets, 10);
}

// While the robot falls or is down, neither the command nor the sets have an effect.
TEST_F(JointStreamBench, IsCutOffByAFall) {
  begin();
  stream({6 * kUnits_per_deg, 0, 0, 0}, 10);
  const auto upright = bench.imu_sample;
  // A quick turn forward about y.
  bench.imu_sample.gyro_raw[1] = 4 * 1'878;
  for (int cycle = 0; cycle < 100 && bench.now().state == State::kStreaming; ++cycle)
    stream({6 * kUnits_per_deg, 0, 0, 0}, 1);
  bench.imu_sample = upright;
  ASSERT_EQ(bench.now().state, State::kFalling);
  const int taken = values().taken_sets;
  bench.command(Command::kStream);
  stream({6 * kUnits_per_deg, 0, 0, 0}, 2);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
  EXPECT_EQ(values().taken_sets, taken);
}

// The joints return to the standing pose, although sets keep coming.
TEST_F(JointStreamBench, EndsWithALowSupply) {
  begin();
  for (auto& drive : bench.drives) drive.set_object(0x6079, 0, 6'200);
  stream({6 * kUnits_per_deg, 0, 0, 0}, 150);
  EXPECT_EQ(bench.now().state, State::kStreaming);
  stream({6 * kUnits_per_deg, 0, 0, 0}, 150);
  EXPECT_EQ(bench.now().state, State::kLowBattery);
  EXPECT_EQ(bench.target(0), standing[0]);
  bench.command(Command::kStream);
  bench.run_ms(20);
  EXPECT_EQ(bench.now().refusal, Reason::kSupplyLow);
}

// After a fault no set moves anything.
TEST_F(JointStreamBench, IsCutOffByAFault) {
  begin();
  stream({6 * kUnits_per_deg, 0, 0, 0}, 10);
  bench.imu_speaks = false;
  stream({6 * kUnits_per_deg, 0, 0, 0}, 10);
  EXPECT_EQ(bench.now().state, State::kFault);
  EXPECT_EQ(bench.now().reason, Reason::kImuSilent);
  const int taken = values().taken_sets;
  stream({6 * kUnits_per_deg, 0, 0, 0}, 10);
  EXPECT_EQ(values().taken_sets, taken);
}

TEST(JointStreamWithoutBias, IsRefused) {
  ControllerBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  ASSERT_EQ(bench.values().diagnosis.gyro_calibrations, 0);
  bench.command(Command::kStream);
  bench.run_ms(20);
  EXPECT_EQ(bench.now().state, State::kStanding);
  EXPECT_EQ(bench.now().refusal, Reason::kGyroBiasUnknown);
}

}  // namespace
}  // namespace koboshi::app
