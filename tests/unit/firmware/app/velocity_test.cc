#include "firmware/walk/velocity.h"

#include <gtest/gtest.h>

#include <vector>

#include "firmware/canopen/emergency.h"
#include "firmware/canopen/frame.h"
#include "tests/support/controller_bench.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;
using test::kVelocityIdentifier;
using walk::Velocity;
using walk::VelocityLimits;

constexpr std::uint16_t kSdoResponse = 0x581;

void send(ControllerBench& bench, const Velocity& velocity) {
  hal::CanFrame frame{.identifier = kVelocityIdentifier, .size = 6};
  canopen::store_u16(&frame.data[0], static_cast<std::uint16_t>(velocity.forward_mm_per_s));
  canopen::store_u16(&frame.data[2], static_cast<std::uint16_t>(velocity.left_mm_per_s));
  canopen::store_u16(&frame.data[4], static_cast<std::uint16_t>(velocity.turn_mrad_per_s));
  bench.board.can.deliver(frame);
  bench.run_ms(1);
}

// Writes two bytes by expedited download. Returns the abort code, or 0 on success.
std::uint32_t write(ControllerBench& bench, std::uint16_t index, std::uint8_t subindex, std::int16_t value) {
  hal::CanFrame frame{.identifier = 0x601, .size = 8, .data = {0x2B}};
  canopen::store_u16(&frame.data[1], index);
  frame.data[3] = subindex;
  canopen::store_u16(&frame.data[4], static_cast<std::uint16_t>(value));
  bench.sent.clear();
  bench.board.can.deliver(frame);
  bench.run_ms(1);
  const auto response = bench.last_sent(kSdoResponse);
  EXPECT_TRUE(response.has_value());
  return response->data[0] == 0x80 ? canopen::load_u32(&response->data[4]) : 0;
}

TEST(VelocityLimits, ClampEachComponent) {
  const VelocityLimits limits{400, 300, 200, 1500};
  EXPECT_EQ(clamped({401, -201, 1501}, limits), (Velocity{400, -200, 1500}));
  EXPECT_EQ(clamped({-331, 201, -1501}, limits), (Velocity{-300, 200, -1500}));
  EXPECT_EQ(clamped({-300, 200, -1500}, limits), (Velocity{-300, 200, -1500}));
}

TEST(ControllerVelocity, IsSetByOneFrame) {
  ControllerBench bench;
  bench.run_ms(10);
  send(bench, {300, -100, 1000});
  EXPECT_EQ(bench.values().velocity, (Velocity{300, -100, 1000}));
  send(bench, {-250, 100, -1000});
  EXPECT_EQ(bench.values().velocity, (Velocity{-250, 100, -1000}));
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
}

TEST(ControllerVelocity, OutOfRangeInAFrameIsRefusedAsAWhole) {
  ControllerBench bench;
  bench.run_ms(10);
  send(bench, {100, 20, -30});
  for (const Velocity& wrong : {Velocity{331, 0, 0}, Velocity{-261, 0, 0}, Velocity{0, 131, 0},
                                Velocity{0, -131, 0}, Velocity{0, 0, 1601}, Velocity{0, 0, -1601}}) {
    send(bench, {100, 20, -30});
    EXPECT_EQ(bench.now().refusal, Reason::kNone);
    send(bench, wrong);
    EXPECT_EQ(bench.now().refusal, Reason::kVelocityOutOfRange);
    EXPECT_EQ(bench.values().velocity, (Velocity{100, 20, -30}));
  }
}

// Both services have the same check and the same effects; an SDO client is told by an abort, the sender of a
// frame by an emergency message for each of its objects, once.
TEST(ControllerVelocity, OutOfRangeIsReportedWhateverServiceBroughtIt) {
  ControllerBench bench;
  bench.run_ms(10);
  EXPECT_EQ(write(bench, kVelocityObject, 1, 331), 0x0609'0031u);
  EXPECT_EQ(bench.now().refusal, Reason::kVelocityOutOfRange);
  EXPECT_EQ(write(bench, kVelocityObject, 1, 330), 0u);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  bench.sent.clear();
  send(bench, {0, 0, 1601});
  send(bench, {0, 0, 1602});
  std::vector<std::uint8_t> reported;
  for (const auto& sent : bench.sent) {
    const hal::CanFrame& frame = sent.frame;
    if (frame.identifier != 0x081) continue;
    EXPECT_EQ(canopen::load_u16(&frame.data[0]), canopen::error_code::kParameter);
    EXPECT_EQ(canopen::load_u16(&frame.data[3]), kVelocityObject);
    reported.push_back(frame.data[5]);
  }
  EXPECT_EQ(reported, (std::vector<std::uint8_t>{1, 2, 3}));
  bench.sent.clear();
  send(bench, {0, 0, 1000});
  const auto cleared = bench.last_sent(0x081);
  ASSERT_TRUE(cleared);
  EXPECT_EQ(canopen::load_u16(&cleared->data[0]), canopen::error_code::kNoError);
}

TEST(ControllerCommand, UnknownIsReportedWhateverServiceBroughtIt) {
  ControllerBench bench;
  bench.run_ms(10);
  bench.sent.clear();
  bench.command(static_cast<Command>(77));
  const auto reported = bench.last_sent(0x081);
  ASSERT_TRUE(reported);
  EXPECT_EQ(canopen::load_u16(&reported->data[0]), canopen::error_code::kParameter);
  EXPECT_EQ(canopen::load_u16(&reported->data[3]), kRequestObject);
  bench.sent.clear();
  bench.command(Command::kPlay, 1);  // the state does not permit it, which telemetry tells
  EXPECT_EQ(canopen::load_u16(&bench.last_sent(0x081)->data[0]), canopen::error_code::kNoError);
}

TEST(ControllerVelocity, DoesNotHideTheRefusalOfACommand) {
  ControllerBench bench;
  bench.run_ms(10);
  bench.command(Command::kPlay, 1);
  ASSERT_EQ(bench.now().refusal, Reason::kNotInThisState);
  send(bench, {100, 20, -30});
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
}

TEST(ControllerVelocity, IsAlsoCheckedFromAnSdoClient) {
  ControllerBench bench;
  bench.run_ms(10);
  EXPECT_EQ(write(bench, kVelocityObject, 1, 331), 0x0609'0031u);
  EXPECT_EQ(write(bench, kVelocityObject, 1, -261), 0x0609'0032u);
  EXPECT_EQ(write(bench, kVelocityObject, 2, 131), 0x0609'0031u);
  EXPECT_EQ(write(bench, kVelocityObject, 3, -1601), 0x0609'0032u);
  EXPECT_EQ(bench.values().velocity, Velocity{});
  EXPECT_EQ(write(bench, kVelocityObject, 2, -100), 0u);
  EXPECT_EQ(bench.values().velocity, (Velocity{0, -100, 0}));
  send(bench, {331, 0, 0});  // a refused frame does not change the SDO value
  EXPECT_EQ(bench.values().velocity, (Velocity{0, -100, 0}));
}

TEST(ControllerVelocity, IsClampedToItsLimits) {
  ControllerBench bench;
  bench.run_ms(10);
  send(bench, {300, -100, 1000});
  EXPECT_EQ(write(bench, kVelocityLimitsObject, 1, 250), 0u);
  EXPECT_EQ(write(bench, kVelocityLimitsObject, 3, 0), 0u);
  EXPECT_EQ(bench.values().velocity, (Velocity{250, 0, 1000}));
  EXPECT_EQ(write(bench, kVelocityLimitsObject, 4, -1), 0x0609'0032u);
  EXPECT_EQ(write(bench, kVelocityLimitsObject, 4, 6'001), 0x0609'0031u);
  EXPECT_EQ(write(bench, kVelocityLimitsObject, 1, 600), 0u);
  send(bench, {600, 0, 0});
  EXPECT_EQ(bench.values().velocity, (Velocity{600, 0, 0}));
}

}  // namespace
}  // namespace koboshi::app
