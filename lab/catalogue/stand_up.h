#pragma once

#include <optional>
#include <string>

#include "lab/experiment/field_table.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/fall_observer.h"
#include "lab/trial/outcome.h"

namespace koboshi::lab {

// Whether the robot gets up from any pose: dropped limp with a random attitude and random joint angles, it
// settles, and is commanded to get up. It has succeeded when it stands by itself, upright and still; the time
// counts from the command.
struct StandUpOptions : ExperimentSetup {
  double drop_m = 0.05;
  double joint_share = 0.8;  // of each joint's range, about its middle, in which its angle is drawn
};

struct StandUpTrial {
  Outcome outcome = Outcome::kSurvived;  // a fall is none: it is what the experiment is about
  std::string error{};
  bool down = false;               // has not stood within all attempts
  bool not_at_once = false;        // has not stood after the first attempt
  std::optional<double> time_s{};  // from the command until it stood
  FallHistory history{};
};
[[nodiscard]] const FieldTable<StandUpTrial>& stand_up_fields();

// Plays a trial of a robot, which has the names and limits of the joints, in the scenario's world.
[[nodiscard]] StandUpTrial play_stand_up(const simulation::Scenario& start,
                                         const sim_board::RobotDescription& robot,
                                         const StandUpOptions& options, std::uint64_t seed);

// The experiment has one cell and concludes success_rate, first_attempt_rate, attempts_mean, and by how the
// robot lay prone_median_s and so on. Throws InputError.
[[nodiscard]] Experiment make_stand_up(const StandUpOptions& options);

}  // namespace koboshi::lab
