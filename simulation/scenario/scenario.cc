#include "simulation/scenario/scenario.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "sim_board/description/load.h"
#include "sim_board/description/schema/roles.h"
#include "simulation/scenario/paths.h"

namespace koboshi::simulation {
namespace {

InputError error_at(const SourcedName& name, const std::string& found, const std::string& expected) {
  return InputError(name.source, name.line, found, expected);
}

InputError unknown_name(const SourcedName& name, const std::string& what,
                        const std::vector<std::string>& known) {
  return error_at(name, "the unknown " + what + " " + one_line(name.text), expected_names(name.text, known));
}

template <typename T>
const T& find_named(const std::vector<T>& items, const SourcedName& name, const char* what) {
  const auto item = std::ranges::find(items, name.text, &T::name);
  if (item != items.end()) return *item;
  std::vector<std::string> known;
  for (const T& each : items) known.push_back(each.name);
  throw unknown_name(name, what, known);
}

// A role of the joints of humanoids, with its side or for both: a scenario for many robots sets it where the
// robot has it.
bool is_role(const std::string& name) {
  const std::vector<std::string>& roles = sim_board::role_names();
  const auto is_known = [&roles](const std::string& role) {
    return std::ranges::find(roles, role) != roles.end();
  };
  return is_known(name) || is_known("left_" + name);
}

// The roles of the initial pose that the robot does not have. A robot that cannot be read has all: another
// message says what is wrong with it.
std::vector<std::string> missing_roles(const Scenario& scenario) {
  std::vector<std::string> missing;
  if (scenario.initial.joints.empty()) return missing;
  try {
    const sim_board::RobotDescription robot = sim_board::load_robot(scenario.robot);
    for (const InitialJoint& initial : scenario.initial.joints)
      if (is_role(initial.joint.text) && robot.find_joints(initial.joint.text).empty())
        missing.push_back(initial.joint.text);
  } catch (const InputError&) {
    missing.clear();
  }
  return missing;
}

// As for motions: the robot file gives limits in radians, the scenario in degrees, and rounding may differ.
constexpr double kLimitTolerance_rad = 1e-4 * kRadPerDegree;

void check_initial(const InitialJoint& initial, const sim_board::RobotDescription& robot,
                   std::set<int>& set_before) {
  const std::vector<sim_board::MirroredJoint> joints = robot.find_joints(initial.joint.text);
  if (joints.empty() && is_role(initial.joint.text)) return;  // left_out_text() names it
  if (joints.empty()) static_cast<void>(find_named(robot.joints, initial.joint, "joint"));  // always throws
  for (const auto& [index, sign] : joints) {
    const sim_board::JointDescription& joint = robot.joints[static_cast<std::size_t>(index)];
    const double position_rad = sign * initial.position_rad;
    if (!set_before.insert(index).second)
      throw error_at(initial.joint, "a second angle for " + joint.name, "one angle a joint");
    if (position_rad >= joint.lower_rad - kLimitTolerance_rad &&
        position_rad <= joint.upper_rad + kLimitTolerance_rad) {
      continue;
    }
    throw error_at(initial.joint, joint.name + " = " + degrees_text(position_rad),
                   "a number from " + degrees_text(joint.lower_rad) + " to " + degrees_text(joint.upper_rad) +
                       " degrees, the joint's limits");
  }
}

bool concerns_frames(Fault::Kind kind) {
  return kind >= Fault::Kind::kFramesLost && kind <= Fault::Kind::kFramesDoubled;
}

bool names_joint(const SourcedName& target) {
  return !target.text.empty() && target.text != kControllerTarget;
}

void check_fault(const Fault& fault, const sim_board::RobotDescription& robot) {
  using Kind = Fault::Kind;
  const bool of_drive = fault.kind == Kind::kDriveSilent || fault.kind == Kind::kDrivePowerLoss ||
                        fault.kind == Kind::kEncoderBreak || fault.kind == Kind::kDriveOverheat;
  if (of_drive || (concerns_frames(fault.kind) && names_joint(fault.target))) {
    const sim_board::JointDescription& joint = find_named(robot.joints, fault.target, "joint");
    if (fault.kind == Kind::kDriveOverheat && !joint.servo.winding)
      throw error_at(fault.target, "a servo without a winding", "one whose type says how it warms");
  }
  if (fault.kind == Kind::kImuStop && !robot.imu) {
    throw error_at(fault.target, "a fault of an IMU", "a robot that has one");
  }
  if (fault.kind == Kind::kBatteryDischarge && !robot.battery)
    throw error_at(fault.target, "a fault of a battery", "a robot that has one");
  const bool has_ankle =
      fault.side == hal::Side::kLeft ? robot.left_ankle.has_value() : robot.right_ankle.has_value();
  if (fault.kind == Kind::kAnkleStop && !has_ankle) {
    throw error_at(fault.target, "a fault of the " + fault.target.text + " ankle sensor",
                   "a robot that has one");
  }
}

std::vector<std::string> materials_of(const Scenario& scenario, const sim_board::RobotDescription& robot) {
  std::set<std::string> materials{scenario.ground.material};
  for (const GroundShape& shape : scenario.ground.shapes) materials.insert(shape.surface.material);
  for (const sim_board::LinkDescription& link : robot.links)
    for (const sim_board::BoxDescription& box : link.collisions) materials.insert(box.surface.material);
  materials.erase("");
  return {materials.begin(), materials.end()};
}

void check_materials(const Scenario& scenario, const sim_board::RobotDescription& robot) {
  const std::vector<std::string> known = materials_of(scenario, robot);
  for (const NamedMaterialPair& pair : scenario.materials) {
    for (const SourcedName& name : pair.names) {
      if (std::ranges::find(known, name.text) != known.end()) continue;
      if (known.empty())
        throw error_at(name, "the material " + one_line(name.text), "a robot or ground that is made of one");
      throw unknown_name(name, "material", known);
    }
  }
}

// Integral of sin(pi x) from 0 to `part` of the half wave.
double half_sine_integral(double part) {
  return (1.0 - std::cos(std::numbers::pi * part)) / std::numbers::pi;
}

}  // namespace

const std::vector<std::string>& Fault::kind_names() {
  static const std::vector<std::string> kNames{
      "drive_silent",     "drive_power_loss",   "encoder_break",  "drive_overheat",
      "supply_drop",      "battery_discharge",  "imu_stop",       "ankle_stop",
      "controller_stop",  "bus_unacknowledged", "bus_dominant",   "frames_lost",
      "frames_corrupted", "frames_delayed",     "frames_doubled", "babbling_node"};
  return kNames;
}

Eigen::Vector3d Push::mean_force_W_N(std::uint64_t start_us, std::uint64_t end_us) const {
  const std::uint64_t from_us = std::max(start_us, at_us);
  const std::uint64_t to_us = std::min(end_us, at_us + duration_us);
  if (from_us >= to_us) return Eigen::Vector3d::Zero();
  const double duration = static_cast<double>(duration_us);
  const double from = static_cast<double>(from_us - at_us) / duration;
  const double to = static_cast<double>(to_us - at_us) / duration;
  const double integral =
      shape == Shape::kRectangle ? to - from : half_sine_integral(to) - half_sine_integral(from);
  return force_W_N * (integral * duration / static_cast<double>(end_us - start_us));
}

std::vector<std::filesystem::path> input_files(const Scenario& scenario) {
  std::vector<std::filesystem::path> files{scenario.file, scenario.robot};
  if (!scenario.robot_parameters.file.empty()) files.push_back(scenario.robot_parameters.file);
  for (const MotionChoice& motion : scenario.motions) files.push_back(motion.file);
  if (scenario.gait) files.push_back(scenario.gait->file);
  if (scenario.policy) files.push_back(*scenario.policy);
  if (scenario.parameter_file) files.push_back(*scenario.parameter_file);
  return files;
}

void check(const Command& command, const sim_board::RobotDescription& robot) {
  for (const StreamedJoint& streamed : command.stream) find_named(robot.joints, streamed.joint, "joint");
}

void check(const Push& push, const sim_board::RobotDescription& robot) {
  find_named(robot.links, push.link, "link");
}

void check(const Fault& fault, const sim_board::RobotDescription& robot) { check_fault(fault, robot); }

std::vector<std::string> motion_names(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const MotionChoice& motion : scenario.motions) names.push_back(motion.name());
  if (scenario.gait) names.emplace_back(kGaitMotion);
  return names;
}

std::string left_out_text(const Scenario& scenario) {
  std::string missing;
  for (const std::string& motion : scenario.missing_motions)
    missing += (missing.empty() ? "motion " : ", motion ") + motion;
  if (!scenario.missing_parameter_file.empty())
    missing += (missing.empty() ? "" : ", ") + ("parameter file " + scenario.missing_parameter_file);
  for (const std::string& role : missing_roles(scenario))
    missing += (missing.empty() ? "" : ", ") + ("the initial angle of " + role);
  if (missing.empty()) return {};
  std::string text = robot_text(scenario.robot) + " lacks, and the run leaves out: " + missing;
  if (scenario.robot_parameters.file.empty()) text += "; " + bring_up_remedy(scenario.robot);
  return text;
}

void check(const Scenario& scenario, const sim_board::RobotDescription& robot) {
  std::set<int> set_before;
  for (const InitialJoint& joint : scenario.initial.joints) check_initial(joint, robot, set_before);
  for (const Command& command : scenario.commands) check(command, robot);
  for (const Push& push : scenario.pushes) check(push, robot);
  for (const Fault& fault : scenario.faults) check_fault(fault, robot);
  check_materials(scenario, robot);
  // Recordings tell links and bodies apart by their names.
  for (const FreeBody& body : scenario.bodies)
    if (robot.find_link(body.name.text))
      throw error_at(body.name, "a body named as the robot's link " + one_line(body.name.text),
                     "another name");
  check(scenario.robot_parameters, robot);
}

void check(const RobotParameters& parameters, const sim_board::RobotDescription& robot) {
  const SourcedName& of = parameters.robot;
  if (!of.text.empty() && of.text != robot.name)
    throw InputError(of.source, of.line, "parameters of " + of.text,
                     robot.name + ", whose file lies beside them");
}

}  // namespace koboshi::simulation
