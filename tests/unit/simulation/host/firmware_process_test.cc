#include "simulation/host/firmware_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "firmware/canopen/frame.h"
#include "simulation/assembly/prepared_scenario.h"
#include "simulation/scenario/reader.h"
#include "tests/unit/sim_board/can/transport/outside.h"

namespace koboshi::simulation {
namespace {

using testing::Contains;
using testing::Not;

class FirmwareProcessTest : public testing::Test {
 protected:
  void play(std::uint64_t services) {
    for (std::uint64_t i = 0; i < services; ++i, now_us_ += 1'000) firmware_.service(now_us_);
  }
  static std::span<const std::byte> storage() {
    static const PreparedScenario prepared =
        prepare(read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml"));
    return prepared.storage_contents;
  }

  sim_board::test::Outside outside_;
  FirmwareProcess firmware_{storage(), outside_};
  std::uint64_t now_us_ = 0;
};

TEST_F(FirmwareProcessTest, IsNode1OfTheBus) {
  play(100);
  EXPECT_THAT(outside_.heard, Contains(hal::CanFrame{.identifier = canopen::kHeartbeatBase + 1, .size = 1}));
  EXPECT_FALSE(firmware_.drive_enabled());
  EXPECT_EQ(firmware_.frames_lost(), 0u);
}

TEST_F(FirmwareProcessTest, StartsASensorThatHasBootedOnce) {
  const auto start = canopen::encode(canopen::NmtMessage{canopen::NmtCommand::kStart, 37});
  play(40);
  EXPECT_THAT(outside_.heard, Not(Contains(start)));
  outside_.said.push_back({.identifier = canopen::kHeartbeatBase + 37, .size = 1});
  play(10);
  EXPECT_THAT(outside_.heard, Contains(start).Times(1));
}

TEST_F(FirmwareProcessTest, ResetsItsOwnNodesOnly) {
  const auto orders = [this] {
    std::vector<hal::CanFrame> orders;
    std::ranges::copy_if(outside_.heard, std::back_inserter(orders),
                         [](const hal::CanFrame& frame) { return frame.identifier == canopen::kNmtCobId; });
    return orders;
  };
  play(30);  // the firmware listens for another master
  EXPECT_THAT(orders(), testing::IsEmpty());
  play(10);
  std::vector<hal::CanFrame> resets;
  for (std::uint8_t node = 16; node <= 38; ++node)
    resets.push_back(canopen::encode(canopen::NmtMessage{canopen::NmtCommand::kResetNode, node}));
  EXPECT_THAT(orders(), testing::UnorderedElementsAreArray(resets));
}

TEST_F(FirmwareProcessTest, AnswersTheOperatorsCommands) {
  play(100);
  outside_.said.push_back({.identifier = 0x601, .size = 8, .data = {0x40, 0x00, 0x10}});
  play(10);
  EXPECT_THAT(outside_.heard, Contains(testing::Field(&hal::CanFrame::identifier, 0x581)));
}

TEST_F(FirmwareProcessTest, StepsAsideForAnExistingController) {
  play(5);
  EXPECT_FALSE(firmware_.found_second_master());
  outside_.said.push_back({.identifier = canopen::kSyncCobId});
  play(5);
  EXPECT_TRUE(firmware_.found_second_master());
  EXPECT_TRUE(firmware_.has_given_way());
  outside_.heard.clear();
  play(1'000);
  EXPECT_TRUE(outside_.heard.empty());
}

TEST_F(FirmwareProcessTest, CountsFramesLostToAFullFifo) {
  outside_.full = true;
  play(100);
  EXPECT_GT(firmware_.frames_lost(), 0u);
}

}  // namespace
}  // namespace koboshi::simulation
