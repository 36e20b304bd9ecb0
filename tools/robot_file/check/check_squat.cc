#include <cmath>
#include <numbers>
#include <string_view>

#include <fmt/format.h>

#include "tools/motion_check/body.h"
#include "tools/motion_check/servo_curve.h"
#include "tools/robot_file/check/checked_model.h"

namespace koboshi::tools {
namespace {

using simulation::Severity;

constexpr double kHighShare = 0.8;  // of a servo's torque, as in the motion check

// The angles of a squat with the trunk upright, and the joints that bend.
struct SquatPose {
  std::vector<double> angles_rad;
  std::vector<std::size_t> legs;
};

// Nothing for a robot without such legs, or whose limits do not permit the squat.
std::optional<SquatPose> squat_of(const sim_board::RobotDescription& robot) {
  SquatPose pose{.angles_rad = std::vector<double>(robot.joints.size(), 0.0), .legs = {}};
  for (const char* name : {"hip_pitch", "knee", "ankle_pitch"}) {
    const std::vector<sim_board::MirroredJoint> joints = robot.find_joints(name);
    if (joints.size() != 2) return std::nullopt;
    const bool is_knee = std::string_view(name) == "knee";
    for (const auto& [index, sign] : joints) {
      const auto joint = static_cast<std::size_t>(index);
      const auto knee = static_cast<std::size_t>(robot.find_joints("knee").front().joint);
      const double bends = robot.joints[knee].upper_rad > -robot.joints[knee].lower_rad ? 1.0 : -1.0;
      pose.angles_rad[joint] = sign * bends * (is_knee ? 0.5 : -0.25) * std::numbers::pi;
      const sim_board::JointDescription& limits = robot.joints[joint];
      if (pose.angles_rad[joint] < limits.lower_rad || pose.angles_rad[joint] > limits.upper_rad)
        return std::nullopt;
      pose.legs.push_back(joint);
    }
  }
  return pose;
}

// The battery while six servos stall; without a battery, the servo's own supply.
double lowest_supply_V(const sim_board::RobotDescription& robot, const sim_board::ServoDescription& servo) {
  if (!robot.battery) return servo.supply_V;
  constexpr double kStalled = 6.0;
  return robot.battery->open_circuit_V /
         (1.0 + kStalled * robot.battery->internal_resistance_ohm / servo.resistance_ohm);
}

}  // namespace

// The weight on two legs that are bent alike.
std::optional<Squat> check_squat(CheckedModel& model) {
  const sim_board::RobotDescription& robot = model.robot;
  if (robot.find_joints("knee").size() != 2) return std::nullopt;
  const std::optional<SquatPose> pose = squat_of(robot);
  if (!pose) return std::nullopt;
  Body body(robot);
  Stance stance;
  body.solve_at_rest(pose->angles_rad, stance);
  Squat squat;
  for (const std::size_t joint : pose->legs) {
    const sim_board::ServoDescription& servo = robot.joints[joint].servo;
    const double torque_Nm = stance.torques_Nm[joint];
    const double share = torque_share(servo, torque_Nm, 0.0, lowest_supply_V(robot, servo));
    if (share > squat.share) squat = {robot.joints[joint].name, std::abs(torque_Nm), share};
  }
  if (squat.share <= kHighShare) return squat;
  const bool cannot = squat.share > 1.0;
  model.add("R009", cannot ? Severity::kError : Severity::kWarning, model.places.of("joint", squat.joint),
            fmt::format("{} taking {:.0f} % of its servo's torque in a squat with knees at 90 deg",
                        squat.joint, 100.0 * squat.share),
            fmt::format("at most {:.0f} %", 100.0 * (cannot ? 1.0 : kHighShare)),
            "A stronger servo, shorter legs, or less weight.");
  return squat;
}

}  // namespace koboshi::tools
