#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "sim_board/description/load.h"
#include "simulation/assembly/storage_contents.h"
#include "simulation/host/in_process_host.h"
#include "simulation/host/qemu_host.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/reader.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/firmware/policy/lean_policy.h"
#include "tools/run/run.h"

namespace koboshi::tools {
namespace {

void expect_same_bytes(const simulation::Scenario& scenario) {
  RunOptions options{.scenario = scenario, .out = {}};
  options.scenario.duration_us = 10'000'000;
  const test::TemporaryFolder folder;
  options.out = folder.path / "host";
  const RunResult host = run(options, nullptr);
  options.out = folder.path / "target";
  options.make_host = simulation::in_qemu(KOBOSHI_IMAGE);
  const RunResult target = run(options, nullptr);

  EXPECT_FALSE(target.failure) << *target.failure;
  EXPECT_EQ(host.summary.state_hash, target.summary.state_hash);
  for (const char* const file : {"can.log", "trace.csv", "summary.json"}) {
    const std::string bytes = test::read_file(folder.path / "host" / file);
    EXPECT_GT(bytes.size(), 100u) << file;
    EXPECT_TRUE(bytes == test::read_file(folder.path / "target" / file))
        << file << " differs; see koboshi diff";
  }
}

TEST(Lockstep, EqualsTheInProcessRunToTheByte) {
  expect_same_bytes(simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml"));
}

// Generating the walk is most of the firmware's arithmetic.
TEST(Lockstep, EqualsTheInProcessRunWhileWalkingByCommand) {
  expect_same_bytes(simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/go.yaml"));
}

// Also while a policy adds to it: its arithmetic has instructions of the core's own.
TEST(Lockstep, EqualsTheInProcessRunWithAPolicy) {
  const test::TemporaryFolder folder;
  const auto robot =
      simulation::load_named_model(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"));
  simulation::Scenario scenario = simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/go.yaml");
  scenario.policy = test::write_policy(folder.path / "lean.kpol", test::lean_policy(robot.model));
  scenario.parameters.push_back({{"policy_enabled", scenario.file, 0}, 1.0});
  expect_same_bytes(scenario);
}

// Storage without a robot model, and with corrupt contents.
TEST(Lockstep, EqualsTheInProcessRunOnEmptyAndDamagedStorage) {
  std::vector<std::byte> broken =
      simulation::make_storage_contents(std::vector<std::byte>(3000, std::byte{0x55}), {});
  for (const std::vector<std::byte>& storage : {std::vector<std::byte>{}, broken}) {
    simulation::InProcessHost host(storage);
    simulation::QemuHost target(KOBOSHI_IMAGE, storage);
    hal::BatchInput input;
    input.transmit_space.fill(32);
    hal::BatchOutput from_host;
    hal::BatchOutput from_target;
    std::size_t frames = 0;
    for (int i = 0; i < 2000; ++i, input.now_us += 1000) {
      input.tick = i % 10 == 9;
      host.exchange(input, from_host);
      target.exchange(input, from_target);
      const auto a = from_host.frames.view();
      const auto b = from_target.frames.view();
      ASSERT_TRUE(std::ranges::equal(a, b)) << "at " << input.now_us << " us";
      ASSERT_EQ(from_host.drive_enabled, from_target.drive_enabled);
      ASSERT_EQ(from_host.watchdog_kicked, from_target.watchdog_kicked);
      frames += a.size();
    }
    EXPECT_GT(frames, 50u);
  }
}

}  // namespace
}  // namespace koboshi::tools
