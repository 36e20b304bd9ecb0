#pragma once

#include <string>

#include "lab/experiment/field_table.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/fall_observer.h"
#include "lab/trial/outcome.h"

namespace koboshi::lab {

// A long time of random commands and pushes of any size, without help: a fall that the robot does not get up
// from and a fault end what it does, but not the clock.
struct MarathonOptions : ExperimentSetup {
  double hours = 1.0;
  double highest_N_s_per_kg = 0.6;  // of the pushes, one in 5 to 30 s
};

struct MarathonTrial {
  Outcome outcome = Outcome::kSurvived;
  std::string error{};
  bool down = false;  // does not stand at the end
  std::uint64_t faults = 0;
  double distance_m = 0.0;  // walked
  double time_s = 0.0;
  FallHistory history{};
};
[[nodiscard]] const FieldTable<MarathonTrial>& marathon_fields();

// The experiment has one cell and concludes stands_at_the_end, seeds, and the total of each quantity. Throws
// InputError.
[[nodiscard]] Experiment make_marathon(const MarathonOptions& options);

}  // namespace koboshi::lab
