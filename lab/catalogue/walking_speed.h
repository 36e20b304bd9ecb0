#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/field_table.h"
#include "lab/experiment/report.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/scenario_trial.h"

namespace koboshi::lab {

// How fast the robot walks forward, backward, sideways and on the spot: in each direction the command is
// raised until more than 5 of 100 seeds do not sustain it over the distance. Each trial begins standing, and
// its clock with the command. The speed counts along the heading at the start, the turn rate as yaw over
// time. Odd seeds go to the left, even ones to the right.
struct SpeedLadder {
  enum class Direction { kForward, kBackward, kSideways, kTurn };
  // "forward"; the names in files and options, in the order of the enumerators.
  static const std::vector<std::string>& names();

  Direction direction = Direction::kForward;
  std::vector<double> commands;  // m/s, of kTurn rad/s; the slowest first
};

struct WalkingSpeedOptions : ExperimentSetup {
  std::vector<SpeedLadder> ladders{
      {SpeedLadder::Direction::kForward, {0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4}},
      {SpeedLadder::Direction::kBackward, {0.05, 0.1, 0.15, 0.2, 0.25, 0.3}},
      {SpeedLadder::Direction::kSideways, {0.03, 0.06, 0.09, 0.12, 0.15, 0.18}},
      {SpeedLadder::Direction::kTurn, {0.25, 0.5, 0.75, 1.0, 1.25, 1.5}}};
  std::vector<std::string> only = SpeedLadder::names();  // ladders that are played
  double distance_m = 10.0 * kBodyHeight_m;
  double turns = 1.0;  // on the spot
};

struct SpeedTrial {
  Outcome outcome = Outcome::kSurvived;
  std::string error{};
  bool not_sustained = true;
  // Results of a sustained walk; the turn rate and its energy only on the spot, the others only elsewhere.
  std::optional<double> speed_m_per_s{};
  std::optional<double> turn_rad_per_s{};
  std::optional<double> steady_percent{};   // of the command, from the third second on
  std::optional<double> landing_weights{};  // Landings: 95th percentile of the walk's landings
  std::optional<double> drift_m{};          // to the side, on the spot in any direction
  std::optional<double> energy_J_per_m{};
  std::optional<double> energy_J_per_rad{};
  std::optional<double> heading_off_deg{};  // unsigned
};
[[nodiscard]] const FieldTable<SpeedTrial>& speed_fields();

// A ladder for each direction. Throws InputError.
[[nodiscard]] Experiment make_walking_speed(const WalkingSpeedOptions& options);

// Judges a walk over a commanded distance of `way` m or rad. `time_s` since the command; `sign` is -1 for
// walks to the right.
[[nodiscard]] SpeedTrial judge_walk(SpeedLadder::Direction direction, double distance, double sign,
                                    double time_s, const ScenarioTrial& walk);

// The speed in each direction at its highest command that was sustained: forward_m_per_s and so on, with
// 95 % confidence intervals.
[[nodiscard]] Conclusions walking_speed_conclusions(const Experiment& experiment,
                                                    const ExperimentResult& result);

}  // namespace koboshi::lab
