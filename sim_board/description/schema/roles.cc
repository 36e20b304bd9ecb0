#include "sim_board/description/schema/roles.h"

#include <array>

namespace koboshi::sim_board {
namespace {

constexpr std::string_view kLeft = "left_";
constexpr std::string_view kRight = "right_";

// From the trunk outwards.
constexpr std::array kMiddle{"head_pan", "head_tilt", "waist_yaw", "waist_roll", "waist_pitch"};
constexpr std::array kOfASide{"hip_yaw",    "hip_roll",       "hip_pitch",     "knee",         "ankle_pitch",
                              "ankle_roll", "shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow",
                              "wrist_yaw",  "wrist_roll",     "wrist_pitch",   "gripper"};

}  // namespace

const std::vector<std::string>& role_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all(kMiddle.begin(), kMiddle.end());
    for (const std::string_view side : {kLeft, kRight})
      for (const char* name : kOfASide) all.push_back(std::string(side) + name);
    return all;
  }();
  return names;
}

std::string other_side(std::string_view name) {
  if (name.starts_with(kLeft)) return std::string(kRight).append(name.substr(kLeft.size()));
  if (name.starts_with(kRight)) return std::string(kLeft).append(name.substr(kRight.size()));
  return std::string(name);
}

}  // namespace koboshi::sim_board
