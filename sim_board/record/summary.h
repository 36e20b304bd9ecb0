#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace koboshi::sim {

// What a walk comes to. Not a number where there was nothing to measure.
struct WalkSummary {
  double distance_m = 0.0;  // net, along the heading at the start
  double speed_m_per_s = 0.0;
  double lateral_drift_m = 0.0;  // to the left
  double heading_drift_rad = 0.0;
  double energy_J = 0.0;                   // that the servos took from their supply, net
  double zmp_rms_error_m = 0.0;            // measured by the firmware against planned, aligned in time
  double zmp_lag_s = 0.0;                  // by which the measured ZMP was later than the planned one
  double zmp_margin_p05_m = 0.0;           // 5th percentile of the true ZMP's distance to the support's edge
  double zmp_sensor_vs_truth_rms_m = 0.0;  // by the ankle sensors against the contact forces
  double roll_rms_rad = 0.0;               // of the trunk, true
  double foot_lift_m = 0.0;  // of a sole's lowest corner, greatest in a step, median over the steps
};

// Something that happened in a run.
struct RunEvent {
  std::uint64_t time_us = 0;
  std::string kind;                                                  // docs/reference/events.md lists them
  std::string text;                                                  // one sentence
  nlohmann::ordered_json fields = nlohmann::ordered_json::object();  // the same as data, by kind
};

// What a run comes to. The same inputs and seed give the same bytes of summary.json: no path, date or host is
// in it.
struct RunSummary {
  bool fell = false;    // the trunk leaned further than a robot comes back from by itself
  std::string verdict;  // "stands; fell once at 3.2 s and got up in 3.4 s; 0 faults"
  std::size_t falls = 0;
  bool stands = false;  // at the end
  double duration_s = 0.0;
  double can_bus_load = 0.0;  // 0..1
  std::string state_hash;
  std::uint64_t faults = 0;
  std::uint64_t solver_warnings = 0;
  std::string stepper;
  // While the robot stands or plays a motion on its own feet: largest difference of the trunk's height from
  // that of the pose it is told to take, and farthest that a loaded foot slid.
  double base_height_error_max_m = 0.0;
  double foot_slip_max_m = 0.0;
  std::optional<WalkSummary> walk{};  // of a run in which one was played
  std::vector<RunEvent> events{};     // in the order of time
};

// The keys of summary.json in their order (docs/reference/summary.md).
nlohmann::ordered_json to_json(const RunSummary& summary);

// Writes the document to a file beside and renames it, so that a reader finds the whole or nothing new.
// Throws std::system_error.
void write_json(const std::filesystem::path& file, const nlohmann::ordered_json& document);

}  // namespace koboshi::sim
