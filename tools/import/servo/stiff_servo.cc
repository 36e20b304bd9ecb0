#include "tools/import/servo/stiff_servo.h"

#include <algorithm>
#include <array>

namespace koboshi::tools {
namespace {

// From the softest to the stiffest.
constexpr std::array kUsual{"krs_2552", "mx_28", "xm430_w350", "mx_64_m6", "mx_106_m6"};

// Moment by which gravity tips the robot about its ankles, by angle: its weight times the height of the
// centre of mass above its lowest point.
double tipping_Nm_per_rad(const ImportedRobot& robot) {
  constexpr double kGravity_m_per_s2 = 9.80665;
  const std::vector<Eigen::Isometry3d> X_BL = link_poses(robot);
  double mass_kg = 0.0;
  double moment_kg_m = 0.0;
  double lowest_m = 0.0;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const ImportedLink& link = robot.links[i];
    mass_kg += link.mass_kg;
    moment_kg_m += link.mass_kg * (X_BL[i] * link.p_LCom_L).z();
    const Eigen::AlignedBox3d extent = extent_of(link);
    if (!extent.isEmpty()) lowest_m = std::min(lowest_m, extent.translated(X_BL[i].translation()).min().z());
  }
  return kGravity_m_per_s2 * (moment_kg_m - mass_kg * lowest_m);
}

double stiffness_Nm_per_rad(const sim_board::ServoDescription& servo) {
  return servo.torque_constant_Nm_per_A / servo.resistance_ohm * servo.supply_V /
         servo.full_voltage_error_rad;
}

}  // namespace

std::string stiff_servo(const std::string& usual, const ImportedRobot& robot,
                        const ServoCatalogue& catalogue) {
  // By hand, 28 November 2026, over 2 m with seeds 901 to 905 in `mild` worlds in mujoco: of a robot
  // with 1.4, as DARwIn-OP with mx_28 servos, 2 of 5 fall, of robots with 2.5 and more none; one with 1.2
  // falls when it steps on the spot.
  constexpr double kLeastRatio = 1.8;
  const double needed_Nm_per_rad = kLeastRatio * tipping_Nm_per_rad(robot);
  const auto first = std::ranges::find(kUsual, usual);
  const auto stiff = std::find_if(first, kUsual.end(), [&](const char* type) {
    return stiffness_Nm_per_rad(catalogue.find(type, robot.file).servo) >= needed_Nm_per_rad;
  });
  return stiff == kUsual.end() ? usual : *stiff;
}

}  // namespace koboshi::tools
