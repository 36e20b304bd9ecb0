#pragma once

#include <string>
#include <vector>

namespace koboshi::sim_board {

// A robot file whose description was recorded (recorded/descriptions.txt). The same on every machine.
struct RecordedRobot {
  std::string name;
  std::string text;
};

// The small robots were recorded with node ids from 25 to 39, some of which belong to sensors since. Their
// files have ids that are larger by this.
inline constexpr int kNodeShift = 50;

// Variants of recorded/koboshi.sdf (other poses, frames, axes, inertias, order of elements), and small robots
// in each version of SDF from 1.5 to 1.9 with frames of all kinds.
std::vector<RecordedRobot> recorded_robots();

}  // namespace koboshi::sim_board
