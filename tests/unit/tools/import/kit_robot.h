#pragma once

#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

namespace koboshi::tools {

// A URDF of a humanoid with twenty hinges as a kit's CAD would export it: boxes, and the faults that a test
// wants.
struct KitRobot {
  double middle_m = 0.0;         // y of the mid-plane
  double ankle_miss_m = 0.0;     // of the left ankle's roll axis below its pitch axis
  double axis_tilt_rad = 0.0;    // of all pitch axes
  double arms_out_rad = 0.0;     // the angle at which the arms stand out in the source's zero pose
  double hip_yaw_slide_m = 0.0;  // up the hip yaw axis
  int left_knee_sign = 1;        // direction of the left knee's axis
  double inertia_factor = 1.0;   // of all links
  double right_hip_mass_kg = 0.08;
  double forearm_width_m = 0.02;
  double forearm_length_m = 0.06;
  std::string hip_axes = "zxy";   // from the trunk outwards
  std::string ankle_axes = "yx";  // the same
  double roll_incline_rad = 0.0;  // of the ankle's roll axis, down at the front
  bool has_arm_twist = false;     // a joint about the upper arm, before the elbow
  bool has_waist = false;         // three joints between the legs and the arms
  double mass_factor = 1.0;       // of all links
  double effort_Nm = 10.0;        // of all joints
  double turned_rad = 0.0;        // the direction in which the robot looks, from x to the left
  double foot_ahead_m = 0.0;      // of the middle of a foot in front of its ankle
  std::string extra{};            // further elements

  std::string text() const {
    std::string urdf = "<?xml version=\"1.0\"?>\n<robot name=\"kit\">\n  <link name=\"base\"/>\n";
    urdf += link("body", 0.6, 0.1, 0.12, 0.14, 0.07);
    urdf += fixed("base_body", "base", "body", fmt::format("0 {} 0", middle_m),
                  fmt::format("0 0 {}", turned_rad));
    urdf += leg("l", 1.0) + leg("r", -1.0) + waist() + arm("l", 1.0) + arm("r", -1.0);
    urdf += link("n", 0.04, 0.02, 0.02, 0.02, 0.0) + link("h", 0.1, 0.06, 0.06, 0.06, 0.03);
    urdf += hinge("j_n", "body", "n", "0 0 0.16", "0 0 0", "0 0 1", -1.5, 1.5);
    urdf += hinge("j_h", "n", "h", "0 0 0.03", "0 0 0", "0 1 0", -1.0, 1.0);
    return urdf + extra + "</robot>\n";
  }

  std::string link(const std::string& name, double unscaled_kg, double x_m, double y_m, double z_m,
                   double up_m, double ahead_m = 0.0) const {
    const double mass_kg = mass_factor * unscaled_kg;
    const auto moment = [&](double a, double b) { return inertia_factor * mass_kg / 12.0 * (a * a + b * b); };
    const std::string shape =
        fmt::format("<origin xyz=\"{} 0 {}\"/><geometry><box size=\"{} {} {}\"/></geometry>", ahead_m, up_m,
                    x_m, y_m, z_m);
    return fmt::format(
        "  <link name=\"{}\">\n    <inertial><origin xyz=\"0 0 {}\"/><mass value=\"{}\"/>\n"
        "      <inertia ixx=\"{}\" iyy=\"{}\" izz=\"{}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>\n"
        "    <visual>{}</visual>\n    <collision>{}</collision>\n  </link>\n",
        name, up_m, mass_kg, moment(y_m, z_m), moment(x_m, z_m), moment(x_m, y_m), shape, shape);
  }
  static std::string fixed(const std::string& name, const std::string& parent, const std::string& child,
                           const std::string& xyz, const std::string& rpy = "0 0 0") {
    return fmt::format(
        "  <joint name=\"{}\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/><origin "
        "xyz=\"{}\" rpy=\"{}\"/></joint>\n",
        name, parent, child, xyz, rpy);
  }
  std::string hinge(const std::string& name, const std::string& parent, const std::string& child,
                    const std::string& xyz, const std::string& rpy, const std::string& axis, double lower,
                    double upper) const {
    return fmt::format(
        "  <joint name=\"{}\" type=\"revolute\"><parent link=\"{}\"/><child link=\"{}\"/>\n"
        "    <origin xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"{}\"/>\n"
        "    <limit lower=\"{}\" upper=\"{}\" effort=\"{}\" velocity=\"20\"/></joint>\n",
        name, parent, child, xyz, rpy, axis, lower, upper, effort_Nm);
  }

 private:
  std::string pitch_axis(double sign = 1.0) const {
    return fmt::format("0 {} {}", sign, sign * axis_tilt_rad);
  }

  std::string roll_axis() const {
    return fmt::format("{} 0 {}", std::cos(roll_incline_rad), -std::sin(roll_incline_rad));
  }

  std::string waist() const {
    if (!has_waist) return {};
    return link("w1", 0.02, 0.02, 0.02, 0.02, 0.0) + link("w2", 0.02, 0.02, 0.02, 0.02, 0.0) +
           link("chest", 0.2, 0.05, 0.05, 0.04, 0.03) +
           hinge("j_w1", "body", "w1", "0 0 0.1", "0 0 0", "0 0 1", -1.0, 1.0) +
           hinge("j_w2", "w1", "w2", "0 0 0", "0 0 0", "1 0 0", -0.3, 0.3) +
           hinge("j_w3", "w2", "chest", "0 0 0", "0 0 0", "0 1 0", -0.3, 0.3);
  }

  std::string leg(const std::string& s, double side) const {
    const bool is_left = side > 0.0;
    std::string urdf = link(s + "1", is_left ? 0.08 : right_hip_mass_kg, 0.03, 0.03, 0.03, 0.0) +
                       link(s + "2", 0.08, 0.03, 0.03, 0.03, 0.0) +
                       link(s + "3", 0.1, 0.03, 0.03, 0.06, -0.04) +
                       link(s + "4", 0.1, 0.03, 0.03, 0.06, -0.04);
    if (ankle_axes.size() > 1) urdf += link(s + "5", 0.08, 0.03, 0.03, 0.03, 0.0);
    urdf += link(fmt::format("{}{}", s, 4 + ankle_axes.size()), 0.08, 0.1, 0.05, 0.01, -0.035, foot_ahead_m);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string xyz = i == 0   ? fmt::format("0 {} {}", 0.04 * side, -0.03 + hip_yaw_slide_m)
                              : i == 1 ? fmt::format("0 0 {}", -hip_yaw_slide_m)
                                       : "0 0 0";
      const char axis = hip_axes[i];
      urdf += hinge(fmt::format("j_{}{}", s, i + 1), i == 0 ? "body" : fmt::format("{}{}", s, i),
                    fmt::format("{}{}", s, i + 1), xyz, "0 0 0",
                    axis == 'z'   ? "0 0 1"
                    : axis == 'x' ? "1 0 0"
                                  : pitch_axis(),
                    axis == 'z'   ? -0.8
                    : axis == 'x' ? -0.6
                                  : -1.8,
                    axis == 'z'   ? 0.8
                    : axis == 'x' ? 0.6
                                  : 0.7);
    }
    const int sign = is_left ? left_knee_sign : 1;
    urdf += hinge("j_" + s + "4", s + "3", s + "4", "0 0 -0.08", "0 0 0", pitch_axis(sign),
                  sign > 0 ? 0.0 : -2.0, sign > 0 ? 2.0 : 0.0);
    for (std::size_t i = 0; i < ankle_axes.size(); ++i) {
      const bool is_pitch = ankle_axes[i] == 'y';
      urdf +=
          hinge(fmt::format("j_{}{}", s, i + 5), fmt::format("{}{}", s, i + 4), fmt::format("{}{}", s, i + 5),
                i == 0 ? "0 0 -0.08" : fmt::format("0 0 {}", is_left ? -ankle_miss_m : 0.0), "0 0 0",
                is_pitch ? pitch_axis() : roll_axis(), is_pitch ? -1.2 : -0.6, is_pitch ? 1.2 : 0.6);
    }
    return urdf;
  }

  std::string arm(const std::string& s, double side) const {
    std::string urdf =
        link(s + "a", 0.04, 0.02, 0.02, 0.02, 0.0) + link(s + "b", 0.08, 0.02, 0.02, 0.06, -0.04) +
        link(s + "c", 0.06, 0.02, forearm_width_m, forearm_length_m, -0.01 - 0.5 * forearm_length_m);
    urdf += hinge("j_" + s + "a", has_waist ? "chest" : "body", s + "a",
                  fmt::format("0 {} {}", 0.09 * side, has_waist ? 0.03 : 0.13), "0 0 0", "0 1 0", -2.5, 2.5);
    urdf += hinge("j_" + s + "b", s + "a", s + "b", "0 0 0", fmt::format("{} 0 0", arms_out_rad * side),
                  "1 0 0", -2.0, 2.0);
    std::string upper = s + "b";
    std::string to_elbow = "0 0 -0.08";
    if (has_arm_twist) {
      urdf += link(s + "t", 0.02, 0.02, 0.02, 0.02, -0.01) +
              hinge("j_" + s + "t", upper, s + "t", "0 0 -0.04", "0 0 0", "0 0 1", -1.0, 1.0);
      upper = s + "t";
      to_elbow = "0 0 -0.04";
    }
    urdf += hinge("j_" + s + "c", upper, s + "c", to_elbow, "0 0 0", "0 1 0", -2.0, 0.5);
    return urdf;
  }
};

}  // namespace koboshi::tools
