#pragma once

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
  std::string extra{};  // further elements

  std::string text() const {
    std::string urdf = "<?xml version=\"1.0\"?>\n<robot name=\"kit\">\n  <link name=\"base\"/>\n";
    urdf += link("body", 0.6, 0.1, 0.12, 0.14, 0.07);
    urdf += fixed("base_body", "base", "body", fmt::format("0 {} 0", middle_m));
    urdf += leg("l", 1.0) + leg("r", -1.0) + arm("l", 1.0) + arm("r", -1.0);
    urdf += link("n", 0.04, 0.02, 0.02, 0.02, 0.0) + link("h", 0.1, 0.06, 0.06, 0.06, 0.03);
    urdf += hinge("j_n", "body", "n", "0 0 0.16", "0 0 0", "0 0 1", -1.5, 1.5);
    urdf += hinge("j_h", "n", "h", "0 0 0.03", "0 0 0", "0 1 0", -1.0, 1.0);
    return urdf + extra + "</robot>\n";
  }

  std::string link(const std::string& name, double mass_kg, double x_m, double y_m, double z_m,
                   double up_m) const {
    const auto moment = [&](double a, double b) { return inertia_factor * mass_kg / 12.0 * (a * a + b * b); };
    const std::string shape = fmt::format(
        "<origin xyz=\"0 0 {}\"/><geometry><box size=\"{} {} {}\"/></geometry>", up_m, x_m, y_m, z_m);
    return fmt::format(
        "  <link name=\"{}\">\n    <inertial><origin xyz=\"0 0 {}\"/><mass value=\"{}\"/>\n"
        "      <inertia ixx=\"{}\" iyy=\"{}\" izz=\"{}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>\n"
        "    <visual>{}</visual>\n    <collision>{}</collision>\n  </link>\n",
        name, up_m, mass_kg, moment(y_m, z_m), moment(x_m, z_m), moment(x_m, y_m), shape, shape);
  }
  static std::string fixed(const std::string& name, const std::string& parent, const std::string& child,
                           const std::string& xyz) {
    return fmt::format(
        "  <joint name=\"{}\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/><origin "
        "xyz=\"{}\"/></joint>\n",
        name, parent, child, xyz);
  }
  static std::string hinge(const std::string& name, const std::string& parent, const std::string& child,
                           const std::string& xyz, const std::string& rpy, const std::string& axis,
                           double lower, double upper) {
    return fmt::format(
        "  <joint name=\"{}\" type=\"revolute\"><parent link=\"{}\"/><child link=\"{}\"/>\n"
        "    <origin xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"{}\"/>\n"
        "    <limit lower=\"{}\" upper=\"{}\" effort=\"10\" velocity=\"20\"/></joint>\n",
        name, parent, child, xyz, rpy, axis, lower, upper);
  }

 private:
  std::string pitch_axis(double sign = 1.0) const {
    return fmt::format("0 {} {}", sign, sign * axis_tilt_rad);
  }

  std::string leg(const std::string& s, double side) const {
    const bool is_left = side > 0.0;
    std::string urdf =
        link(s + "1", is_left ? 0.08 : right_hip_mass_kg, 0.03, 0.03, 0.03, 0.0) +
        link(s + "2", 0.08, 0.03, 0.03, 0.03, 0.0) + link(s + "3", 0.1, 0.03, 0.03, 0.06, -0.04) +
        link(s + "4", 0.1, 0.03, 0.03, 0.06, -0.04) + link(s + "5", 0.08, 0.03, 0.03, 0.03, 0.0) +
        link(s + "6", 0.08, 0.1, 0.05, 0.01, -0.035);
    urdf += hinge("j_" + s + "1", "body", s + "1",
                  fmt::format("0 {} {}", 0.04 * side, -0.03 + hip_yaw_slide_m), "0 0 0", "0 0 1", -0.8, 0.8);
    urdf += hinge("j_" + s + "2", s + "1", s + "2", fmt::format("0 0 {}", -hip_yaw_slide_m), "0 0 0", "1 0 0",
                  -0.6, 0.6);
    urdf += hinge("j_" + s + "3", s + "2", s + "3", "0 0 0", "0 0 0", pitch_axis(), -1.8, 0.7);
    const int sign = is_left ? left_knee_sign : 1;
    urdf += hinge("j_" + s + "4", s + "3", s + "4", "0 0 -0.08", "0 0 0", pitch_axis(sign),
                  sign > 0 ? 0.0 : -2.0, sign > 0 ? 2.0 : 0.0);
    urdf += hinge("j_" + s + "5", s + "4", s + "5", "0 0 -0.08", "0 0 0", pitch_axis(), -1.2, 1.2);
    urdf += hinge("j_" + s + "6", s + "5", s + "6", fmt::format("0 0 {}", is_left ? -ankle_miss_m : 0.0),
                  "0 0 0", "1 0 0", -0.6, 0.6);
    return urdf;
  }

  std::string arm(const std::string& s, double side) const {
    std::string urdf =
        link(s + "a", 0.04, 0.02, 0.02, 0.02, 0.0) + link(s + "b", 0.08, 0.02, 0.02, 0.06, -0.04) +
        link(s + "c", 0.06, 0.02, forearm_width_m, forearm_length_m, -0.01 - 0.5 * forearm_length_m);
    urdf += hinge("j_" + s + "a", "body", s + "a", fmt::format("0 {} 0.13", 0.09 * side), "0 0 0", "0 1 0",
                  -2.5, 2.5);
    urdf += hinge("j_" + s + "b", s + "a", s + "b", "0 0 0", fmt::format("{} 0 0", arms_out_rad * side),
                  "1 0 0", -2.0, 2.0);
    urdf += hinge("j_" + s + "c", s + "b", s + "c", "0 0 -0.08", "0 0 0", "0 1 0", -2.0, 0.5);
    return urdf;
  }
};

}  // namespace koboshi::tools
