#include "tools/import/servo/source_servo.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace koboshi::tools {
namespace {

constexpr double kSupply_V = 24.0;
constexpr double kGravity_m_per_s2 = 9.80665;

// The default robot's servo, 1.345 N m and 7.48 rad/s, beside its mass, 1.2 kg, and its legs, 0.167 m.
constexpr double kTorqueShare = 0.68;    // of m g leg
constexpr double kSpeed_m_per_s = 3.06;  // speed sqrt(leg / m)
// A torque beyond this share of m g leg is no motor's: drawing programmes write 100 or 1000 N m.
constexpr double kMaxTorqueShare = 3.0;
// A faster drive of the same torque brakes less by its back EMF, and nothing else damps the legs. A robot of
// 31 kg whose file gives 20 to 60 N m walks 2 m with five of five seeds at this speed, and with four of
// five at twice as much (28 November 2026, mujoco, mild).
constexpr double kMaxSpeed = 1.0;     // of the similar servo's
constexpr double kLeastSpeed = 0.25;  // a lower one is a placeholder
// Shares of the torque, as in robots/servos/catalogue.xml.
constexpr double kCoulombShare = 0.025;
constexpr double kMaxCoulombShare = 0.1;
constexpr double kViscousShare_s = 0.002;
constexpr double kFullVoltageError_rad = 0.13;
// A controller of a position is stiffer than gravity tips the robot, however weak its motor. With 3 a robot
// of 16 kg whose hips turn at 45 degrees sags by 2 degrees with its weight on one foot, and falls; with 6 it
// stays up and walks (28 November 2026, mujoco, mild).
constexpr double kStiffness = 6.0;  // of m g leg
constexpr double kLeastFullVoltageError_rad = 0.02;

double leg_length_m(const ImportedRobot& robot) {
  const std::vector<Eigen::Isometry3d> X_BL = link_poses(robot);
  const auto anchor = [&](const char* name) -> std::optional<Eigen::Vector3d> {
    const auto joint = robot.find_joint(name);
    if (!joint) return std::nullopt;
    const int link = robot.joints[static_cast<std::size_t>(*joint)].child;
    return X_BL[static_cast<std::size_t>(link)].translation();
  };
  const auto hip = anchor("left_hip_pitch");
  const auto ankle = anchor("left_ankle_pitch");
  constexpr double kUnknown_m = 0.3;
  return hip && ankle && (*hip - *ankle).norm() > 0.02 ? (*hip - *ankle).norm() : kUnknown_m;
}

// Two significant digits, so that joints share types.
double rounded(double value) {
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::round(value / step) * step;
}

// kt and R solve kt V / R = T + Kc and kt (V - kt w) / R = Kc + Kv w.
sim_board::ServoDescription drive_of(double torque_Nm, double speed_rad_per_s, double inertia_kg_m2,
                                     double coulomb_Nm, double stiffness_Nm_per_rad) {
  sim_board::ServoDescription servo;
  servo.supply_V = kSupply_V;
  servo.coulomb_friction_Nm = coulomb_Nm;
  servo.viscous_friction_Nm_s = kViscousShare_s * torque_Nm;
  const double at_rest_Nm = torque_Nm + coulomb_Nm;
  const double braking_Nm_s = (torque_Nm - servo.viscous_friction_Nm_s * speed_rad_per_s) / speed_rad_per_s;
  servo.torque_constant_Nm_per_A = kSupply_V * braking_Nm_s / at_rest_Nm;
  servo.resistance_ohm = servo.torque_constant_Nm_per_A * kSupply_V / at_rest_Nm;
  servo.rotor_inertia_kg_m2 = inertia_kg_m2;
  servo.full_voltage_error_rad =
      std::clamp(at_rest_Nm / stiffness_Nm_per_rad, kLeastFullVoltageError_rad, kFullVoltageError_rad);
  return servo;
}

std::string text_of(const std::string& name, const std::string& source,
                    const sim_board::ServoDescription& servo) {
  return fmt::format(
      "<!-- {} -->\n"
      "<koboshi:servo_type name=\"{}\">\n"
      "  <torque_constant_Nm_per_A>{:.5g}</torque_constant_Nm_per_A>\n"
      "  <resistance_ohm>{:.5g}</resistance_ohm>\n"
      "  <supply_V>{:g}</supply_V>\n"
      "  <rotor_inertia_kg_m2>{:.4g}</rotor_inertia_kg_m2>\n"
      "  <coulomb_friction_Nm>{:.4g}</coulomb_friction_Nm>\n"
      "  <viscous_friction_Nm_s>{:.4g}</viscous_friction_Nm_s>\n"
      "  <full_voltage_error_rad>{:.4g}</full_voltage_error_rad>\n"
      "</koboshi:servo_type>\n",
      source, name, servo.torque_constant_Nm_per_A, servo.resistance_ohm, servo.supply_V,
      servo.rotor_inertia_kg_m2, servo.coulomb_friction_Nm, servo.viscous_friction_Nm_s,
      servo.full_voltage_error_rad);
}

}  // namespace

double mass_of(const ImportedRobot& robot) {
  double mass_kg = 0.0;
  for (const ImportedLink& link : robot.links) mass_kg += link.mass_kg;
  return mass_kg;
}

SourceServos::SourceServos(const ImportedRobot& robot, ServoCatalogue& catalogue, ImportReport& report)
    : catalogue_(catalogue), report_(report), leg_m_(leg_length_m(robot)) {
  similar_torque_Nm_ = kTorqueShare * mass_of(robot) * kGravity_m_per_s2 * leg_m_;
  similar_speed_rad_per_s_ = kSpeed_m_per_s / std::sqrt(leg_m_);
}

std::string SourceServos::type_of(const ImportedJoint& joint) {
  const double most_Nm = similar_torque_Nm_ * kMaxTorqueShare / kTorqueShare;
  const bool has_torque = joint.effort_Nm > 0.0 && joint.effort_Nm <= most_Nm;
  const double torque_Nm = rounded(has_torque ? joint.effort_Nm : similar_torque_Nm_);
  if (!has_torque)
    report_.warnings.push_back(
        fmt::format("{}: {} -> {:g} N m, the default robot's servo scaled to this robot", joint.name,
                    joint.effort_Nm > 0.0
                        ? fmt::format("an effort of {:.4g} N m, which no such robot has", joint.effort_Nm)
                        : std::string("no effort"),
                    torque_Nm));
  const double fastest = kMaxSpeed * similar_speed_rad_per_s_;
  const double speed_rad_per_s = joint.speed_rad_per_s > kLeastSpeed * similar_speed_rad_per_s_
                                     ? std::min(joint.speed_rad_per_s, fastest)
                                     : fastest;
  const double coulomb_Nm =
      joint.coulomb_friction_Nm > 0.0 && joint.coulomb_friction_Nm <= kMaxCoulombShare * torque_Nm
          ? joint.coulomb_friction_Nm
          : kCoulombShare * torque_Nm;
  // The rule of the catalogue for geared servos, through the drive of 36 N m with 0.034 kg m^2.
  const double usual_inertia = 0.034 * std::pow(torque_Nm / 36.0, 0.7);
  const double inertia_kg_m2 =
      joint.rotor_inertia_kg_m2 > 0.01 * usual_inertia && joint.rotor_inertia_kg_m2 < 10.0 * usual_inertia
          ? joint.rotor_inertia_kg_m2
          : usual_inertia;
  const sim_board::ServoDescription servo = drive_of(torque_Nm, speed_rad_per_s, inertia_kg_m2, coulomb_Nm,
                                                     kStiffness / kTorqueShare * similar_torque_Nm_);
  const std::string source = fmt::format(
      "Made by the import: {:g} N m at rest{}, {:.3g} rad/s without load{}. Assumed: the supply and the "
      "error at "
      "full voltage.",
      torque_Nm, has_torque ? " as the source has it" : ", scaled from the default robot", speed_rad_per_s,
      speed_rad_per_s < fastest ? "" : ", as the default robot's servo scaled to this robot");
  for (int i = 1;; ++i) {
    const std::string name = fmt::format("drive_{:g}{}", torque_Nm, i > 1 ? "_" + std::to_string(i) : "");
    if (catalogue_.add(name, servo, text_of(name, source, servo))) return name;
  }
}

}  // namespace koboshi::tools
