#pragma once

#include <string>

namespace koboshi::test {

// The joint angles of pose `i` of a walk on the spot, as a motion file has them.
inline std::string bent_legs(int i) {
  return "{hip_roll: 4, hip_pitch: -15.90, knee: " + std::to_string(20 + i % 30) +
         ".5, ankle_pitch: -27.82, shoulder_roll: 8, elbow: -20}";
}

// The text of a motion of this many steps, which go through 500 poses in turn. `pose` gives the joint angles
// of one by its number.
template <typename Pose>
std::string large_motion(int steps, const Pose& pose, const std::string& time_s = "0.5") {
  constexpr int kPoses = 500;
  std::string text = "version: 2\nrobot: koboshi\nname: large\nposes:\n";
  for (int i = 0; i < kPoses; ++i) text += "  p" + std::to_string(i) + ": " + pose(i) + "\n";
  text += "steps:\n";
  for (int i = 0; i < steps; ++i)
    text += "  - {pose: p" + std::to_string(i % kPoses) + ", time_s: " + time_s + "}\n";
  return text;
}

}  // namespace koboshi::test
