#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/behaviour/state.h"
#include "simulation/assembly/simulation.h"
#include "simulation/host/qemu_host.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/reader.h"

namespace koboshi::tools {
namespace {

constexpr std::uint32_t kMean = 60'000;  // mean instructions in the 10 ms of a tick while the robot moves
constexpr std::uint32_t kWorst = 100'000;
constexpr std::uint32_t kStack_bytes = 3072;

// Instructions that the firmware executes per tick: the tick itself and the ten preceding service calls.
struct Ticks {
  std::vector<std::uint32_t> moving;
  std::uint32_t worst = 0;  // maximum over all ticks, including those while booting
  std::uint32_t stack_peak_bytes = 0;
};

Ticks measure(std::uint64_t duration_us) {
  simulation::QemuHost* host = nullptr;
  simulation::Simulation simulation(simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml"),
                                    [&](std::span<const std::byte> contents) {
                                      auto made =
                                          std::make_unique<simulation::QemuHost>(KOBOSHI_IMAGE, contents);
                                      host = made.get();
                                      return made;
                                    });
  simulation::RunRecorder recorder(simulation, nullptr);
  Ticks ticks;
  std::uint32_t instructions = 0;
  while (simulation.board().now_us() < duration_us) {
    simulation.advance();
    instructions += host->last_instructions();
    if (!simulation.board().electronics().last_input().tick) continue;
    recorder.record_tick();
    if (recorder.telemetry().state == behaviour::State::kMotion) ticks.moving.push_back(instructions);
    ticks.worst = std::max(ticks.worst, instructions);
    instructions = 0;
  }
  ticks.stack_peak_bytes = host->stack_peak_bytes();
  return ticks;
}

TEST(Budget, IsKept) {
  const Ticks ticks = measure(8'000'000);
  ASSERT_GT(ticks.moving.size(), 300u);
  std::uint64_t sum = 0;
  for (const std::uint32_t instructions : ticks.moving) sum += instructions;
  const auto mean = static_cast<std::uint32_t>(sum / ticks.moving.size());
  const std::uint32_t worst = *std::ranges::max_element(ticks.moving);
  RecordProperty("instructions_mean", static_cast<int>(mean));
  RecordProperty("instructions_worst", static_cast<int>(worst));
  RecordProperty("stack_bytes", static_cast<int>(ticks.stack_peak_bytes));
  std::printf("moving: mean %u, worst %u; worst of all %u; stack %u\n", mean, worst, ticks.worst,
              ticks.stack_peak_bytes);
  EXPECT_LE(mean, kMean);
  EXPECT_GT(mean, kMean / 20);  // a lower count would mean that the counter did not run
  EXPECT_LE(worst, kWorst);
  EXPECT_LE(ticks.stack_peak_bytes, kStack_bytes);
  EXPECT_GT(ticks.stack_peak_bytes, kStack_bytes / 10);
}

}  // namespace
}  // namespace koboshi::tools
