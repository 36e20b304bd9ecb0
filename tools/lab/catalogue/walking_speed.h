#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/lab/experiment/ladder.h"
#include "tools/lab/experiment/report.h"
#include "tools/lab/trial/commanded_walk.h"
#include "tools/lab/trial/perturbation.h"

namespace koboshi::tools {

// How fast the robot walks ahead, back, to the side and round: in each direction the command is raised until
// more than 5 of 100 seeds do not sustain it over the way. Each begins standing, and its clock with the
// command; what counts is the speed made good along the heading at the start, or the yaw over time. Odd seeds
// go to the left, even ones to the right.

// A direction and the commands in it, the slowest first.
struct SpeedLadder {
  enum class Direction { kForward, kBackward, kSideways, kTurn };
  // "forward"; what files and options call them, in their order.
  static const std::vector<std::string>& names();

  Direction direction = Direction::kForward;
  std::vector<double> commands;  // m/s, of kTurn rad/s
};

struct WalkingSpeedOptions : CommandedWalkOptions {
  std::vector<SpeedLadder> ladders{};
  double way_m = 10.0 * kBodyHeight_m;
  double turns = 1.0;  // on the spot
};

struct WalkingSpeed {
  Experiment experiment;
  std::vector<Ladder> ladders;
};

// Throws sim::InputError.
[[nodiscard]] WalkingSpeed make_walking_speed(const WalkingSpeedOptions& options);

// What a walk comes to, of `way` m or rad that were asked for, by the values of its scenario. `time_s` since
// the command; `sign` -1 of what goes to the right.
[[nodiscard]] Values judge_walk(SpeedLadder::Direction direction, double way, double sign, double time_s,
                                const Values& scenario_values);

// The speed of each direction at its highest command that was sustained: forward_m_per_s and so on, with
// 95 % intervals.
[[nodiscard]] Conclusions walking_speed_conclusions(const WalkingSpeed& speed, const ClimbResult& result);

}  // namespace koboshi::tools
