#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/field_table.h"
#include "lab/experiment/report.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/outcome.h"

namespace koboshi::lab {

// The walking engine alone against the engine with a policy, in the same worlds under the same pushes. A push
// is a half sine of 0.1 s at the trunk's centre of mass, in 16 directions in turn, at a random phase of the
// walk. Walks have no pushes.
struct ComparisonOptions : ExperimentSetup {
  static const std::vector<std::string>& all_activities();

  std::filesystem::path policy{};  // image; empty: the engine alone
  std::vector<std::string> activities = all_activities();
  std::vector<double> impulses_N_s_per_kg{0.3, 0.36, 0.44};
  double walk_s = 10.0;  // without pushes
};

struct ComparedTrial {
  Outcome outcome = Outcome::kSurvived;
  std::string error{};
  bool lost = false;
  // Empty where the trial was lost.
  std::optional<double> drift_m_per_s{};  // distance from where the command leads to, over the time
  std::optional<double> power_W{};
  std::optional<double> lean_rad{};  // root mean square of the trunk's angle from the vertical
  bool policy_stopped = false;       // by its watchdog
};
[[nodiscard]] const FieldTable<ComparedTrial>& compared_fields();

// A cell for each activity and impulse, without and with the policy. Throws InputError.
[[nodiscard]] Experiment make_comparison(const ComparisonOptions& options);

// Probability, for two controllers that are lost equally often, that trials of the same seeds split at least
// as unevenly as `only_first` to `only_second` (exact sign test, two-sided).
[[nodiscard]] double sign_test(std::size_t only_first, std::size_t only_second);

}  // namespace koboshi::lab
