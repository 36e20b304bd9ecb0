#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace koboshi::simulation {

// Results of a walk. NaN for values that could not be measured.
struct WalkSummary {
  double distance_m = 0.0;  // net, along the initial heading
  double speed_m_per_s = 0.0;
  double lateral_drift_m = 0.0;  // positive to the left
  double heading_drift_rad = 0.0;
  double energy_J = 0.0;                   // net energy that the servos drew from their supply
  double zmp_rms_error_m = 0.0;            // measured by the firmware against planned, aligned in time
  double zmp_lag_s = 0.0;                  // delay of the measured ZMP relative to the planned one
  double zmp_margin_p05_m = 0.0;           // 5th percentile of the true ZMP's distance from the edge of the
                                           // support polygon
  double zmp_sensor_vs_truth_rms_m = 0.0;  // ankle sensors against contact forces
  double roll_rms_rad = 0.0;               // true roll of the trunk
  double foot_lift_m = 0.0;  // height of a sole's lowest corner: maximum per step, median over the steps
};

// An event of a run.
struct RunEvent {
  std::uint64_t time_us = 0;
  std::string kind;                                                  // listed in docs/reference/events.md
  std::string text;                                                  // one sentence
  nlohmann::ordered_json fields = nlohmann::ordered_json::object();  // the same as data; the fields depend on
                                                                     // the kind
};

// Results of a run. The same inputs and seed give the same bytes of summary.json, so it contains no path,
// date or host name.
struct RunSummary {
  bool fell = false;    // the trunk's lean exceeded the limit beyond which the robot cannot recover its
                        // balance
  std::string verdict;  // "stands; fell once at 3.2 s and got up in 3.4 s; 0 faults"
  std::size_t falls = 0;
  bool stands = false;  // at the end
  double duration_s = 0.0;
  double can_bus_load = 0.0;  // 0..1
  std::string state_hash;
  std::uint64_t faults = 0;
  std::uint64_t solver_warnings = 0;
  std::string stepper;
  // While the robot stands or plays a motion on its feet: maximum difference between the trunk's height and
  // that of the target pose, and maximum slip of a loaded foot.
  double base_height_error_max_m = 0.0;
  double foot_slip_max_m = 0.0;
  std::vector<std::string> lost_abilities{};  // names of what the robot's body and sensors cannot do,
                                              // and of what the scenario leaves out for want of a file
  std::optional<WalkSummary> walk{};          // only for runs with a walk
  std::vector<RunEvent> events{};             // in order of time
};

// Returns the document of summary.json with its keys in order (docs/reference/summary.md).
nlohmann::ordered_json to_json(const RunSummary& summary);

// Replaces a file atomically with this document, by a temporary file and a rename. Throws std::system_error.
void write_json(const std::filesystem::path& file, const nlohmann::ordered_json& document);

}  // namespace koboshi::simulation
