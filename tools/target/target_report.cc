#include "tools/target/target_report.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <numeric>
#include <stdexcept>

#include "base/text/error.h"
#include "firmware/behaviour/state.h"
#include "simulation/assembly/simulation.h"
#include "simulation/host/qemu_host.h"
#include "simulation/observe/run_recorder.h"
#include "tools/target/part_counter.h"

namespace koboshi::tools {
namespace {

nlohmann::ordered_json read_description(const std::filesystem::path& image) {
  std::filesystem::path path = image;
  path += ".json";
  std::ifstream file(path);
  if (!file) throw InputError(path, 0, "no such file", "the image's description, which ./run target writes");
  return nlohmann::ordered_json::parse(file);
}

struct Tick {
  bool moving = false;
  std::uint64_t instructions = 0;
  PartCounts parts{};
};

void add(PartCounts& sum, const PartCounts& counts) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += counts[i];
}

std::uint64_t sum(const PartCounts& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

// Plays the scenario to its end and sets `stack_peak_bytes`.
std::vector<Tick> play(const simulation::Scenario& scenario, const std::filesystem::path& image,
                       PartCounter& counter, std::uint32_t& stack_peak_bytes) {
  simulation::QemuHost* host = nullptr;
  simulation::Simulation simulation(scenario, [&](std::span<const std::byte> contents) {
    auto made = std::make_unique<simulation::QemuHost>(image, contents, counter.arguments());
    host = made.get();
    return made;
  });
  simulation::RunRecorder recorder(simulation, nullptr);
  std::vector<Tick> ticks;
  Tick tick;
  while (!simulation.finished()) {
    simulation.advance();
    tick.instructions += host->last_instructions();
    add(tick.parts, counter.next_service());
    if (!simulation.board().electronics().last_input().tick) continue;
    add(tick.parts, counter.next_tick());
    recorder.record_tick();
    const behaviour::State state = recorder.telemetry().state;
    tick.moving = state == behaviour::State::kMotion || state == behaviour::State::kWalking;
    ticks.push_back(tick);
    tick = {};
  }
  stack_peak_bytes = host->stack_peak_bytes();
  return ticks;
}

template <typename Number>
Distribution distribution_of(const std::vector<Tick>& ticks, Number number) {
  std::vector<std::uint64_t> values;
  for (const Tick& tick : ticks) values.push_back(number(tick));
  return distribution(std::move(values));
}

}  // namespace

Distribution distribution(std::vector<std::uint64_t> values) {
  if (values.empty()) throw std::invalid_argument("no ticks to measure");
  std::ranges::sort(values);
  const auto total = std::accumulate(values.begin(), values.end(), std::uint64_t{0});
  const std::size_t rank = (values.size() * 99 + 99) / 100;  // the smallest that 99 % do not exceed
  return {.mean = static_cast<double>(total) / static_cast<double>(values.size()),
          .p99 = values[rank - 1],
          .max = values.back()};
}

TargetReport measure_target(const simulation::Scenario& scenario, const std::filesystem::path& image) {
  TargetReport report;
  report.image = read_description(image);
  PartCounter counter(report.image);
  const std::vector<Tick> ticks = play(scenario, image, counter, report.stack_peak_bytes);
  std::vector<Tick> moving;
  std::ranges::copy_if(ticks, std::back_inserter(moving), &Tick::moving);

  report.ticks = ticks.size();
  report.ticks_moving = moving.size();
  report.instructions = distribution_of(ticks, [](const Tick& tick) { return tick.instructions; });
  report.instructions_moving = distribution_of(moving, [](const Tick& tick) { return tick.instructions; });
  for (std::size_t part = 0; part < report.by_part.size(); ++part) {
    const auto of_part = [part](const Tick& tick) { return tick.parts[part]; };
    report.by_part[part] = distribution_of(ticks, of_part);
    report.by_part_moving[part] = distribution_of(moving, of_part);
  }
  report.rest = distribution_of(ticks, [](const Tick& tick) { return tick.instructions - sum(tick.parts); });
  return report;
}

}  // namespace koboshi::tools
