#include "lab/bring_up/start_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "sim_board/description/hinge_tree.h"
#include "sim_board/world/foot.h"
#include "sim_board/world/gravity.h"
#include "simulation/assembly/robot_parameters.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/parse.h"

namespace koboshi::tools {
namespace {

using simulation::ParameterSetting;
using simulation::RobotParameters;

// --- Measures

const sim_board::JointDescription& joint_of(const sim_board::RobotDescription& robot,
                                            const std::string& role) {
  const auto joint = robot.find_joint(role);
  if (!joint)
    throw InputError(robot.file, robot.line, "no joint " + role,
                     "legs with hip pitch, knee and ankles to walk");
  return robot.joints[static_cast<std::size_t>(*joint)];
}

double stiffness_Nm_per_rad(const sim_board::ServoDescription& servo) {
  return servo.torque_constant_Nm_per_A / servo.resistance_ohm * servo.supply_V /
         servo.full_voltage_error_rad;
}

double mean_z(const sim_board::RobotDescription& robot, const char* role) {
  return 0.5 * (joint_of(robot, std::string("left_") + role).p_MJ.z() +
                joint_of(robot, std::string("right_") + role).p_MJ.z());
}

// --- Scaling

// By which power of the ratio of the legs' lengths a parameter grows, by the unit at the end of its key.
double exponent_of(std::string_view key) {
  struct Unit {
    std::string_view end;
    double exponent;
  };
  constexpr std::array<Unit, 12> kUnits{{{"_mm_per_s2", 0.0},
                                         {"_mm_per_s", 0.5},
                                         {"_mrad_per_s2", -1.0},
                                         {"_mrad_per_s", -0.5},
                                         {"_deg_s_per_m", -0.5},
                                         {"_deg_per_s", -0.5},
                                         {"_rad_per_m", -1.0},
                                         {"_deg", 0.0},
                                         {"_percent", 0.0},
                                         {"_mm", 1.0},
                                         {"_ms", 0.5},
                                         {"_s", 0.5}}};
  for (const Unit& unit : kUnits) {
    if (key.ends_with(unit.end)) return unit.exponent;
  }
  return 0.0;
}

double* find(RobotParameters& parameters, std::string_view key) {
  const auto found = std::ranges::find(
      parameters.settings, key,
      [](const ParameterSetting& setting) -> std::string_view { return setting.name.text; });
  return found == parameters.settings.end() ? nullptr : &found->value;
}

void multiply(RobotParameters& parameters, std::string_view key, double factor) {
  if (double* value = find(parameters, key)) *value *= factor;
}

void set(RobotParameters& parameters, const std::string& key, double value) {
  if (double* present = find(parameters, key)) {
    *present = value;
  } else {
    parameters.settings.push_back({{key, parameters.file, 0}, value});
  }
}

constexpr double kMostCompliance_rad_per_m = 3.0;  // the range of object 0x2131

// Changes a value that the robot's body refuses; false for one that cannot be mended.
bool mend(RobotParameters& parameters, const std::string& refused, const BodyMeasures& body) {
  constexpr double kLess = 0.98;
  const double least_mm = kMmPerM * body.sole_width_m + 2.0;
  if (refused == "com_height_mm" || refused == "longest_step_mm") {
    multiply(parameters, refused, kLess);
    return *find(parameters, refused) >
           0.3 * kMmPerM * (refused == "com_height_mm" ? body.com_m : 0.2 * body.leg_m);
  }
  if (refused == "widest_step_mm") {
    const double* width = find(parameters, "step_width_mm");
    multiply(parameters, refused, kLess);
    return width != nullptr && *find(parameters, refused) > *width;
  }
  if (refused == "step_width_mm" || refused == "narrowest_step_mm") {
    set(parameters, refused, std::max(*find(parameters, refused) + 1.0, least_mm));
    if (*find(parameters, "step_width_mm") < *find(parameters, "narrowest_step_mm"))
      set(parameters, "step_width_mm", *find(parameters, "narrowest_step_mm"));
    if (*find(parameters, "widest_step_mm") < *find(parameters, "step_width_mm"))
      set(parameters, "widest_step_mm", 1.3 * *find(parameters, "step_width_mm"));
    return *find(parameters, refused) < 3.0 * least_mm;
  }
  if (refused.starts_with("fall_to_the_")) {
    *find(parameters, refused) += 1.0;
    return *find(parameters, refused) < 60.0;
  }
  if (refused == "touchdown_load_N") {
    set(parameters, refused, 0.0);
    return true;
  }
  return false;
}

void fit(RobotParameters& parameters, const BodyMeasures& body, const robot::RobotModel& model) {
  constexpr int kMostChanges = 200;
  for (int change = 0;; ++change) {
    try {
      static_cast<void>(simulation::compile_robot_parameters(parameters, model));
      return;
    } catch (const InputError& error) {
      const std::string refused = error.found().substr(0, error.found().find(' '));
      if (change == kMostChanges || find(parameters, refused) == nullptr || !mend(parameters, refused, body))
        throw;
    }
  }
}

// --- Motions

std::string compiled_angles(const std::string& text, const simulation::NamedModel& model) {
  const simulation::MotionFile file = simulation::read_motion_text("stand.yaml", text);
  simulation::Diagnostics diagnostics(file.path, file.text);
  const simulation::MotionSource motion = simulation::parse_motion(file, model, diagnostics);
  static_cast<void>(simulation::compile_motion(motion, model, diagnostics));
  diagnostics.throw_errors();
  std::string angles;
  const simulation::PoseSource& pose = motion.poses.front();
  for (std::size_t joint = 0; joint < pose.angles.size(); ++joint) {
    if (pose.angles[joint])
      angles += fmt::format("{}{}: {:.2f}", angles.empty() ? "" : ", ", model.joint_names[joint],
                            kDegreesPerRad * fixed::to_double(*pose.angles[joint]));
  }
  return angles;
}

bool has_shoulders(const simulation::NamedModel& model) {
  return model.model.find(robot::JointRole::kLeftShoulderRoll) &&
         model.model.find(robot::JointRole::kRightShoulderRoll);
}

// The controller goes to the first pose of the first motion when its drives are enabled.
std::string motion_head(const StartValues& values, const std::string& name, const std::string& origin) {
  return fmt::format("# {}.\nversion: 2\nrobot: {}\nname: {}\nposes:\n", origin, values.parameters.robot.text,
                     name);
}

// Arms that hang straight down touch the legs of many robots.
std::string hanging_text(const simulation::NamedModel& model) {
  return fmt::format("  hanging: {{others: zero{}}}\n", has_shoulders(model) ? ", shoulder_roll: 15" : "");
}

std::string pose_text(const std::string& name, const std::string& from, double com_forward_m,
                      double com_height_m, double width_m) {
  return fmt::format(
      "  {}: {{from: {}, com: {{x_mm: {:.1f}, z_mm: {:.1f}}}, left_foot: {{y_mm: {:.1f}}}, right_foot: "
      "{{y_mm: {:.1f}}}}}\n",
      name, from, kMmPerM * com_forward_m, kMmPerM * com_height_m, 0.5 * kMmPerM * width_m,
      -0.5 * kMmPerM * width_m);
}

}  // namespace

BodyMeasures measure(const sim_board::RobotDescription& robot) {
  const auto feet = sim_board::feet_of(robot);
  if (!feet[0] || !feet[1])
    throw InputError(robot.file, robot.line, "no soles below two ankles", "two legs with feet to walk");
  const mechanics::HingeTree tree = sim_board::hinge_tree(robot);
  const std::vector<double> zero(robot.joints.size(), 0.0);
  const auto X_WLs = tree.poses(Eigen::Isometry3d::Identity(), zero);
  const Eigen::Isometry3d left = X_WLs[static_cast<std::size_t>(feet[0]->link)] * feet[0]->X_LSole;
  const Eigen::Isometry3d right = X_WLs[static_cast<std::size_t>(feet[1]->link)] * feet[1]->X_LSole;
  // Anchors are in the model's frame, in which the base stands at its pose.
  const Eigen::Isometry3d X_MW = tree.links()[0].X_ML;
  BodyMeasures body;
  double front_m = -1.0;
  double back_m = 1.0;
  double inner_m = 1.0;
  double other_inner_m = -1.0;
  for (const Eigen::Vector3d& corner_L : feet[0]->corners_L) {
    const Eigen::Vector3d corner_S = feet[0]->X_LSole.inverse() * corner_L;
    front_m = std::max(front_m, corner_S.x());
    back_m = std::min(back_m, corner_S.x());
    inner_m = std::min(inner_m, corner_S.y());
  }
  for (const Eigen::Vector3d& corner_L : feet[1]->corners_L)
    other_inner_m = std::max(other_inner_m, (feet[1]->X_LSole.inverse() * corner_L).y());
  const double sole_z_m = 0.5 * ((X_MW * left).translation().z() + (X_MW * right).translation().z());
  body.leg_m = mean_z(robot, "hip_pitch") - sole_z_m;
  body.com_m = (X_MW * tree.centre_of_mass(X_WLs)).z() - sole_z_m;
  body.stance_m = left.translation().y() - right.translation().y();
  body.sole_width_m = other_inner_m - inner_m;
  body.sole_middle_m = 0.5 * (front_m + back_m);
  body.weight_N = robot.total_mass_kg() * sim_board::kGravity_m_per_s2;
  body.stiffness_Nm_per_rad = std::min(stiffness_Nm_per_rad(joint_of(robot, "left_knee").servo),
                                       stiffness_Nm_per_rad(joint_of(robot, "left_ankle_pitch").servo));
  body.supply_V = robot.battery ? robot.battery->open_circuit_V : robot.joints.front().servo.supply_V;
  if (body.leg_m < 0.02 || body.com_m < 0.02)
    throw InputError(robot.file, robot.line,
                     "hips or a centre of mass that are not above the soles at joint angles zero",
                     "legs that hang down");
  return body;
}

StartValues scaled_values(const RobotParameters& reference, const BodyMeasures& from,
                          const sim_board::RobotDescription& robot, const simulation::NamedModel& model,
                          const StartFactors& factors) {
  const BodyMeasures body = measure(robot);
  const double scale = body.leg_m / from.leg_m;
  StartValues values{.parameters = reference, .time_scale = std::sqrt(scale)};
  RobotParameters& parameters = values.parameters;
  parameters.file = robot.file.parent_path() / "parameters.yaml";
  parameters.robot.text = model.robot;
  for (ParameterSetting& setting : parameters.settings) {
    setting.name.source = parameters.file;
    setting.name.line = 0;
    setting.value *= std::pow(scale, exponent_of(setting.name.text));
  }
  for (const char* key : {"lowest_supply_mV", "highest_supply_mV", "low_supply_mV"})
    multiply(parameters, key, body.supply_V / from.supply_V);
  // The plan follows arms and waist; only the reference was tuned without.
  set(parameters, "fixed_upper_body", 0.0);
  set(parameters, "touchdown_load_N", 0.0);
  const double stance = body.stance_m / from.stance_m / scale;
  multiply(parameters, "step_width_mm", stance);
  multiply(parameters, "widest_step_mm", stance);
  set(parameters, "narrowest_step_mm", kMmPerM * body.sole_width_m + 2.0 * scale);
  set(parameters, "com_height_mm",
      *find(parameters, "com_height_mm") * body.com_m / from.com_m / scale * factors.com_height);
  multiply(parameters, "step_time_ms", factors.step_time);
  // A servo sags by the torque of the weight on a lever, over its stiffness; the lever is the parameter's
  // metre.
  const double sag = (body.weight_N / from.weight_N) /
                     (body.stiffness_Nm_per_rad / from.stiffness_Nm_per_rad) * scale * factors.compliance;
  multiply(parameters, "pitch_compliance_rad_per_m", sag);
  multiply(parameters, "roll_compliance_rad_per_m", sag);
  for (const char* key : {"pitch_compliance_rad_per_m", "roll_compliance_rad_per_m"}) {
    if (double* compliance = find(parameters, key))
      *compliance = std::min(*compliance, kMostCompliance_rad_per_m);
  }
  for (ParameterSetting& setting : parameters.settings) {
    if (setting.name.text.starts_with("walking_")) setting.value *= factors.gains;
  }
  if (double* pitch = find(parameters, "trunk_pitch_deg")) *pitch += factors.trunk_pitch_deg;
  fit(parameters, body, model.model);
  values.com_height_m = *find(parameters, "com_height_mm") / kMmPerM;
  values.step_width_m = *find(parameters, "step_width_mm") / kMmPerM;
  values.com_forward_m = body.sole_middle_m;
  return values;
}

double StartValues::value(const std::string& key) const {
  for (const ParameterSetting& setting : parameters.settings) {
    if (setting.name.text == key) return setting.value;
  }
  return 0.0;
}

std::string parameters_text(const StartValues& values, const std::string& origin) {
  std::string text =
      fmt::format("# {}.\nversion: 1\nrobot: {}\nparameters:\n", origin, values.parameters.robot.text);
  for (const ParameterSetting& setting : values.parameters.settings)
    text += fmt::format("  {}: {:.5g}\n", setting.name.text, setting.value);
  return text;
}

StandingPose standing_pose(const StartValues& values, const simulation::NamedModel& model,
                           const std::string& origin) {
  const std::string time = fmt::format("{:.2f}", 1.5 * std::max(1.0, values.time_scale));
  const std::string head = motion_head(values, "stand", origin);
  const std::string hanging = hanging_text(model);
  constexpr int kMostChanges = 20;
  double height_m = values.com_height_m;
  for (int change = 0;; ++change, height_m *= 0.98) {
    const std::string pose =
        pose_text("stand", "hanging", values.com_forward_m, height_m, values.step_width_m);
    const std::string stand = head + pose + hanging + "steps:\n  - {pose: stand, time_s: " + time + "}\n";
    try {
      StandingPose standing{
          .stand_text = stand, .squat_text = {}, .joints_text = compiled_angles(stand, model)};
      standing.squat_text =
          motion_head(values, "squat", origin) + pose + hanging +
          pose_text("down", "stand", values.com_forward_m, 0.85 * height_m, values.step_width_m) +
          fmt::format(
              "steps:\n  - {{pose: stand, time_s: {0}}}\n  - loop:\n      times: 3\n      steps:\n"
              "        - {{pose: down, time_s: {0}, interpolation: minimum_jerk}}\n"
              "        - {{pose: stand, time_s: {0}, interpolation: minimum_jerk}}\n",
              time);
      static_cast<void>(compiled_angles(standing.squat_text, model));
      return standing;
    } catch (const simulation::MotionError& error) {
      if (change == kMostChanges)
        throw InputError("stand.yaml", 0, one_line(error.what()), "a standing pose that the legs reach");
    }
  }
}

}  // namespace koboshi::tools
