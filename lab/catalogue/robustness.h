#pragma once

#include <string>
#include <vector>

#include "lab/experiment/field_table.h"
#include "lab/experiment/report.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/outcome.h"

namespace koboshi::lab {

// Measures the cost of each disturbance alone: in each activity, one factor of the worlds
// (docs/reference/worlds.md) is raised level by level, past the end of `harsh`, until more than a share of
// the trials are lost. All other factors are as in the files, or drawn as in a named world. Without such a
// world a factor with two ends, such as the CoM's place, is at one of them in each part and axis; the slope
// has a random direction.
//
// Pushes are half sines of 0.1 s at the trunk's centre of mass, in 16 directions in turn, at a random phase
// of the walk. Their impulse is a factor itself; with all other factors it is that of kPush*_N_s_per_kg.
struct RobustnessOptions : ExperimentSetup {
  RobustnessOptions() : ExperimentSetup{.scenario = "scenarios/get_up.yaml", .seeds = 64} {}

  static constexpr const char* kNominal = "nominal";
  static const std::vector<std::string>& all_activities();
  static const std::vector<std::string>& all_factors();

  std::vector<std::string> activities = all_activities();
  std::vector<std::string> factors = all_factors();
  // Levels instead of the factor's own, rising; empty: its own. Needs a single factor.
  std::vector<double> levels{};
  // The world of all other factors; "nominal": as in the files, and a factor with two ends is at one of them.
  std::string others = kNominal;
  double full_speed_m_per_s = 0.0;           // at most the robot's limit; 0: the limit
  double distance_m = 10.0 * kBodyHeight_m;  // of a walk with kReferenceLeg_m
  double cliff_share = 0.8;                  // with 64 seeds no level has fewer than 50 trials
};

struct RobustnessTrial {
  Outcome outcome = Outcome::kSurvived;
  std::string error{};
  bool lost = false;         // by any of the outcomes, or
  bool stepped = false;      // pushed while it stood, it kept its balance by steps
  bool not_arrived = false;  // walked less than the distance in twice its time, or stayed down
};
// `cliff_share` is that of the options.
[[nodiscard]] FieldTable<RobustnessTrial> robustness_fields(double cliff_share = 1.0);

// A ladder for each activity and factor. It concludes the share lost at each level. Throws InputError.
[[nodiscard]] Experiment make_robustness(const RobustnessOptions& options);

}  // namespace koboshi::lab
