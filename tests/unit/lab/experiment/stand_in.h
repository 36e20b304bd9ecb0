#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "lab/experiment/field_table.h"
#include "sim_board/random/random_stream.h"

namespace koboshi::lab::test {

struct StandInTrial {
  std::string error{};
  bool fell = false;
  std::optional<double> speed_m_per_s{};
};

inline const FieldTable<StandInTrial>& stand_in_fields() {
  using T = StandInTrial;
  static const FieldTable<T> kFields{
      Fields<T>{{{.name = "fell", .label = "falls"}, &T::fell},
                {{.name = "speed_m_per_s", .label = "speed [mm/s]", .decimals = 1, .factor = 1000.0},
                 &T::speed_m_per_s}}};
  return kFields;
}

// A trial that takes no time: in the cell `shaky` about every third robot falls and has no speed.
struct StandIn {
  Experiment experiment{.name = "stand-in",
                        .cells = {{"calm", {{"ground", "even"}}}, {"shaky", {{"ground", "rough"}}}},
                        .first_seed = 100,
                        .seeds = 25,
                        .inputs = "0f"};
  std::atomic<int> played = 0;

  StandIn() {
    set([this](std::size_t cell, std::uint64_t seed) { return play(cell, seed); });
  }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

  template <typename Play>
  void set(Play play) {
    set_trials(experiment, stand_in_fields(), std::move(play));
  }

  StandInTrial play(std::size_t cell, std::uint64_t seed) {
    ++played;
    sim_board::RandomStream random(seed, experiment.cells[cell].name);
    const double speed_m_per_s = 0.2 + 0.01 * random.normal();
    if (cell == 1 && random.uniform() < 0.33) return {.fell = true};
    return {.speed_m_per_s = speed_m_per_s};
  }
};

}  // namespace koboshi::lab::test
