#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lab/bring_up/start_values.h"
#include "simulation/model/robot_model.h"

namespace koboshi::lab {

// The texts of the motions `stand`, `squat` and `shift`, which compile for this robot.
// `shift` moves the centre of mass over the left foot, then over the right one, as far as the hips permit,
// lets the other foot hang just above the ground, and holds each for a second. `origin` is named in their
// first lines. Throws InputError if the legs do not reach the standing pose.
struct StandingPose {
  std::string stand_text;
  std::string squat_text;
  std::string shift_text;
  std::string joints_text;                                 // the pose's angles as a map of YAML, in degrees
  std::vector<std::pair<std::string, double>> joints_deg;  // the same
  double step_s = 0.0;                                     // time of each move
  // Of `squat` and `shift` those that the legs do not reach at any height, and why; their texts are empty.
  std::map<std::string, std::string> unreached{};
};
[[nodiscard]] StandingPose standing_pose(const StartValues& values, const simulation::NamedModel& model,
                                         const std::string& origin);

}  // namespace koboshi::lab
