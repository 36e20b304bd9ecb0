#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/text/text.h"
#include "firmware/behaviour/state.h"
#include "simulation/assembly/simulation.h"
#include "simulation/host/qemu_host.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/reader.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::tools {
namespace {

constexpr std::uint32_t kMean = 60'000;  // mean instructions in the 10 ms of a tick while the robot moves
constexpr std::uint32_t kWorst = 100'000;
constexpr std::uint32_t kStack_bytes = 4096;

// Instructions that the firmware executes per tick: the tick itself and the ten preceding service calls.
struct Ticks {
  std::vector<std::uint32_t> moving;
  std::uint32_t worst = 0;             // maximum over all ticks, including those while booting
  std::uint32_t worst_after_boot = 0;  // likewise from kBooted_us on, with the tick that starts the walk
  std::uint32_t stack_peak_bytes = 0;

  [[nodiscard]] std::uint32_t moving_mean() const {
    const std::uint64_t sum = std::accumulate(moving.begin(), moving.end(), std::uint64_t{0});
    return static_cast<std::uint32_t>(sum / moving.size());
  }
  [[nodiscard]] std::uint32_t moving_worst() const { return *std::ranges::max_element(moving); }
};

constexpr std::uint64_t kBooted_us = 1'000'000;

Ticks measure(const char* scenario, std::uint64_t duration_us, std::span<const Override> overrides = {}) {
  simulation::QemuHost* host = nullptr;
  simulation::Simulation simulation(
      simulation::read_scenario(std::string(KOBOSHI_SOURCE_DIR "/scenarios/") + scenario, overrides),
      [&](std::span<const std::byte> contents) {
        auto made = std::make_unique<simulation::QemuHost>(KOBOSHI_IMAGE, contents);
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
    const behaviour::State state = recorder.telemetry().state;
    if (state == behaviour::State::kMotion || state == behaviour::State::kWalking)
      ticks.moving.push_back(instructions);
    ticks.worst = std::max(ticks.worst, instructions);
    if (simulation.board().now_us() > kBooted_us)
      ticks.worst_after_boot = std::max(ticks.worst_after_boot, instructions);
    instructions = 0;
  }
  ticks.stack_peak_bytes = host->stack_peak_bytes();
  return ticks;
}

TEST(Budget, IsKept) {
  const Ticks ticks = measure("walk.yaml", 8'000'000);
  ASSERT_GT(ticks.moving.size(), 300u);
  const std::uint32_t mean = ticks.moving_mean();
  const std::uint32_t worst = ticks.moving_worst();
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

// Writes a copy of the default robot whose file `change` has changed. Returns the file.
std::filesystem::path changed_robot(const std::filesystem::path& folder,
                                    const std::function<void(std::string&)>& change) {
  std::filesystem::copy(KOBOSHI_SOURCE_DIR "/robots/koboshi", folder,
                        std::filesystem::copy_options::recursive);
  const std::filesystem::path file = folder / "robot.sdf";
  std::string text = read_text_file(file, "a robot");
  change(text);
  std::ofstream(file) << text;
  return file;
}

void set_axis(std::string& text, const std::string& joint, const std::string& axis) {
  const std::size_t begin = text.find("<xyz>", text.find("<joint name=\"" + joint)) + 5;
  text.replace(begin, text.find("</xyz>", begin) - begin, axis);
}

// Hip yaw and roll turned by 45 degrees.
void turn_hips(std::string& text) {
  for (const std::string side : {"left_", "right_"}) {
    set_axis(text, side + "hip_yaw", "-0.70710678 0 0.70710678");
    set_axis(text, side + "hip_roll", "0.70710678 0 0.70710678");
  }
}

// Hip yaws at 45 degrees about the axis to the side, turned by one motor as those of a NAO.
void couple_hips(std::string& text) {
  set_axis(text, "left_hip_yaw", "0 -0.70710678 0.70710678");
  set_axis(text, "right_hip_yaw", "0 0.70710678 0.70710678");
  const std::size_t begin = text.find("</axis>", text.find("<joint name=\"right_hip_yaw"));
  text.replace(begin, text.find("</joint>", begin) - begin,
               "<mimic joint=\"left_hip_yaw\"><multiplier>-1</multiplier></mimic></axis>");
}

void expect_budget_of_legs_without_closed_form(const std::function<void(std::string&)>& change) {
  const test::TemporaryFolder folder;
  const Override robot{"robot", changed_robot(folder.path / "robot", change).string()};
  const Ticks ticks = measure("go.yaml", 8'000'000, {&robot, 1});
  ASSERT_GT(ticks.moving.size(), 300u);
  const std::uint32_t mean = ticks.moving_mean();
  const std::uint32_t worst = ticks.moving_worst();
  std::printf("moving: mean %u, worst %u; worst after boot %u\n", mean, worst, ticks.worst_after_boot);
  EXPECT_GT(mean, kMean / 2);
  EXPECT_LE(mean, kMean);
  EXPECT_LE(worst, kWorst);
  EXPECT_LE(ticks.worst_after_boot, kWorst);
}

TEST(Budget, OfLegsWithoutClosedForm) { expect_budget_of_legs_without_closed_form(turn_hips); }

TEST(Budget, OfHipYawsOnOneMotor) { expect_budget_of_legs_without_closed_form(couple_hips); }

}  // namespace
}  // namespace koboshi::tools
