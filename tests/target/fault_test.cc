#include <algorithm>

#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/behaviour/state.h"
#include "simulation/assembly/simulation.h"
#include "simulation/assembly/storage_contents.h"
#include "simulation/host/qemu_host.h"
#include "simulation/scenario/reader.h"

namespace koboshi::tools {
namespace {

using cortex_m::FaultRecord;
using cortex_m::wire::Provocation;
using ::testing::HasSubstr;

constexpr std::uint32_t kUndefinedInstruction = 1u << 16;  // in CFSR (ARMv7-M, B3.2.15)
constexpr std::uint32_t kPreciseBusError = 1u << 9;
constexpr std::uint32_t kBusAddressValid = 1u << 15;
constexpr std::uint32_t kStackingError = 1u << 4;
constexpr std::uint32_t kDataViolation = 1u << 1;

class Fault : public ::testing::Test {
 protected:
  hal::BatchOutput serve() {
    hal::BatchOutput output;
    hal::BatchInput input;
    input.transmit_space.fill(32);
    host_.exchange(input, output);
    return output;
  }
  FaultRecord provoke(Provocation provocation) {
    try {
      host_.provoke(provocation);
    } catch (const simulation::FirmwareFault& fault) {
      message_ = fault.what();
      return fault.record();
    }
    ADD_FAILURE() << "no fault";
    return {};
  }

  simulation::QemuHost host_{KOBOSHI_IMAGE, simulation::make_storage_contents({}, {})};
  std::string message_;
};

TEST_F(Fault, RecordsAnUndefinedInstruction) {
  serve();
  const FaultRecord record = provoke(Provocation::kUndefinedInstruction);
  EXPECT_EQ(record.exception, 6u);
  EXPECT_EQ(record.configurable_status, kUndefinedInstruction);
  EXPECT_LT(record.program_counter, 256u * 1024);
  EXPECT_GT(record.program_counter, 0u);
  EXPECT_GT(record.stack_pointer, 0x2000'0000u);
  EXPECT_LE(record.stack_pointer, 0x2000'1000u);
  EXPECT_EQ(record.drive_enable_line, 0u);
  EXPECT_THAT(message_, HasSubstr("usage fault"));
}

TEST_F(Fault, RecordsAnUnmappedAddress) {
  const FaultRecord record = provoke(Provocation::kBadAddress);
  EXPECT_EQ(record.exception, 5u);
  EXPECT_EQ(record.configurable_status, kPreciseBusError | kBusAddressValid);
  EXPECT_EQ(record.bus_address, 0x3000'0000u);
}

TEST_F(Fault, CatchesAStackOverflow) {
  const FaultRecord record = provoke(Provocation::kStackOverflow);
  EXPECT_EQ(record.exception, 4u);
  EXPECT_NE(record.configurable_status & (kStackingError | kDataViolation), 0u);
  EXPECT_LT(record.stack_pointer, 0x2000'0000u);
  EXPECT_EQ(record.program_counter, 0u);  // the stack was full, so nothing was pushed
}

TEST_F(Fault, LeavesStorageIntactAndRestartsTheFirmware) {
  const hal::BatchOutput before = serve();
  provoke(Provocation::kUndefinedInstruction);
  host_.start();
  const hal::BatchOutput after = serve();
  EXPECT_TRUE(std::ranges::equal(before.frames.view(), after.frames.view()));
  EXPECT_GT(after.frames.size, 0u);
  EXPECT_FALSE(after.drive_enabled);
}

// A fault while the robot stands with torque on all joints.
TEST(FaultWhileStanding, PullsTheDriveEnableLineLowAndKeepsTheState) {
  simulation::QemuHost* host = nullptr;
  simulation::Simulation simulation(simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml"),
                                    [&](std::span<const std::byte> contents) {
                                      auto made =
                                          std::make_unique<simulation::QemuHost>(KOBOSHI_IMAGE, contents);
                                      host = made.get();
                                      return made;
                                    });
  while (simulation.board().now_us() < 3'900'000) simulation.advance();
  ASSERT_TRUE(simulation.board().electronics().drive_enable_line());
  try {
    host->provoke(Provocation::kBadAddress);
    FAIL() << "no fault";
  } catch (const simulation::FirmwareFault& fault) {
    EXPECT_EQ(fault.record().drive_enable_line, 0u);
    EXPECT_EQ(fault.record().behaviour_state, static_cast<std::uint32_t>(behaviour::State::kStanding));
  }
}

}  // namespace
}  // namespace koboshi::tools
