#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "simulation/scenario/scenario.h"
#include "tools/target/parts.h"

namespace koboshi::tools {

// Budgets of a tick while the robot moves, in instructions. At one to two cycles an instruction the mean
// takes 8 to 17 % of the 720,000 cycles that a Cortex-M4 of 72 MHz has in 10 ms. The budgets of flash, RAM
// and stack are in the linker script, hal/cortex_m/mps2/image.ld.
inline constexpr std::uint64_t kMeanInstructions = 60'000;
inline constexpr std::uint64_t kMaxInstructions = 100'000;

// Distribution of the number of instructions per tick.
struct Distribution {
  double mean = 0.0;
  std::uint64_t p99 = 0;  // 99th percentile
  std::uint64_t max = 0;
};

// Throws std::invalid_argument when there are no values.
[[nodiscard]] Distribution distribution(std::vector<std::uint64_t> values);

// Resources that the firmware uses on a Cortex-M4. A tick here is everything that the firmware executes in 10
// ms: ten calls of service, and the tick.
struct TargetReport {
  std::size_t ticks = 0;
  std::size_t ticks_moving = 0;
  Distribution instructions;         // of all ticks
  Distribution instructions_moving;  // of ticks in which a motion plays or the robot walks
  std::array<Distribution, kPartNames.size()> by_part;
  std::array<Distribution, kPartNames.size()> by_part_moving;  // of the ticks of `instructions_moving`
  // In the total but in no part: reading the counter before and after each exchange.
  Distribution rest;
  std::uint32_t stack_peak_bytes = 0;  // maximum in the run
  nlohmann::ordered_json image;        // its description, tools/target/describe.py
};

// Plays the scenario with this image of the firmware in QEMU; its description is a file beside it. The same
// image and scenario give the same report. Throws InputError when a file is missing, and what a run
// throws.
[[nodiscard]] TargetReport measure_target(const simulation::Scenario& scenario,
                                          const std::filesystem::path& image);

[[nodiscard]] nlohmann::ordered_json to_json(const TargetReport& report);
// The tables of the report in Markdown, which also reads well on a terminal.
[[nodiscard]] std::string to_tables(const TargetReport& report);
// The page docs/reference/target.md, which names the scenario.
[[nodiscard]] std::string to_page(const TargetReport& report, const std::string& scenario);

}  // namespace koboshi::tools
