#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace koboshi::tools {

// The joints of a humanoid that have a role in the firmware, by limb and from the trunk outwards.
struct RoleJoint {
  std::string_view name;  // "hip_yaw", without its side
  char axis;              // in the zero pose: x, y or z
  std::string_view link;  // the link that it moves: "hip_yaw_link"
};
inline constexpr std::array<RoleJoint, 6> kLegRoles{{{"hip_yaw", 'z', "hip_yaw_link"},
                                                     {"hip_roll", 'x', "hip_roll_link"},
                                                     {"hip_pitch", 'y', "thigh"},
                                                     {"knee", 'y', "shank"},
                                                     {"ankle_pitch", 'y', "ankle_link"},
                                                     {"ankle_roll", 'x', "foot"}}};
inline constexpr std::array<RoleJoint, 3> kArmRoles{{{"shoulder_pitch", 'y', "shoulder_link"},
                                                     {"shoulder_roll", 'x', "upper_arm"},
                                                     {"elbow", 'y', "forearm"}}};
inline constexpr std::array<RoleJoint, 2> kHeadRoles{{{"head_pan", 'z', "neck"}, {"head_tilt", 'y', "head"}}};

// All joints with a role, in the order of their drives: "left_hip_yaw".
[[nodiscard]] const std::vector<std::string>& role_names();
// Returns the role of a joint; null for other names.
[[nodiscard]] const RoleJoint* find_role(std::string_view joint);
// Returns the name with the other side; the name itself without a side.
[[nodiscard]] std::string mirrored_name(const std::string& name);
// Returns the name of the link that a joint moves: "left_thigh" for left_hip_pitch, "waist_link" for waist.
[[nodiscard]] std::string link_name_of(const std::string& joint);

// Returns the range about zero in which a humanoid uses a joint when it walks, squats and gets up, in rad,
// for an axis along x, y or z. 30 degrees to both sides for a joint without a role of the firmware.
[[nodiscard]] std::array<double, 2> usual_range_rad(const std::string& role);

}  // namespace koboshi::tools
