#pragma once

#include <atomic>

#include "sim_board/random/random_stream.h"
#include "tools/lab/experiment/experiment.h"

namespace koboshi::tools::test {

// A trial that takes no time: in the cell `shaky` about every third robot falls and has no speed.
struct StandIn {
  Experiment experiment{
      .name = "stand-in",
      .measures = {{.name = "fell", .kind = Measure::Kind::kEvent, .label = "falls"},
                   {.name = "speed_m_per_s", .label = "speed [mm/s]", .factor = 1000.0, .decimals = 1}},
      .cells = {{"calm", {{"ground", "even"}}}, {"shaky", {{"ground", "rough"}}}},
      .first_seed = 100,
      .seeds = 25,
      .inputs = "0f",
      .play = [this](std::size_t cell, std::uint64_t seed) { return play(cell, seed); }};
  std::atomic<int> played = 0;

  StandIn() = default;
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

  Values play(std::size_t cell, std::uint64_t seed) {
    ++played;
    sim::RandomStream random(seed, experiment.cells[cell].name);
    const double speed_m_per_s = 0.2 + 0.01 * random.normal();
    if (cell == 1 && random.uniform() < 0.33) return {{"fell", 1.0}};
    return {{"fell", 0.0}, {"speed_m_per_s", speed_m_per_s}};
  }
};

}  // namespace koboshi::tools::test
