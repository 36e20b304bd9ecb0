#include "lab/bring_up/start_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
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

namespace koboshi::lab {
namespace {

using simulation::ParameterSetting;
using simulation::RobotParameters;

// --- Measures

const sim_board::JointDescription& joint_of(const sim_board::RobotDescription& robot,
                                            const std::string& role) {
  const auto joint = robot.find_joint(role);
  if (!joint)
    throw InputError(robot.file, robot.line, "no joint " + role,
                     "legs with hip roll and pitch, knee, ankle pitch and ankle roll to walk");
  return robot.joints[static_cast<std::size_t>(*joint)];
}

double stiffness_Nm_per_rad(const sim_board::ServoDescription& servo) {
  return servo.torque_constant_Nm_per_A / servo.resistance_ohm * servo.supply_V /
         servo.full_voltage_error_rad;
}

double weakest_Nm_per_rad(const sim_board::RobotDescription& robot,
                          std::initializer_list<const char*> roles) {
  double weakest = std::numeric_limits<double>::infinity();
  for (const char* role : roles)
    weakest = std::min(weakest, stiffness_Nm_per_rad(joint_of(robot, role).servo));
  return weakest;
}

double mean_z(const sim_board::RobotDescription& robot, const char* role) {
  return 0.5 * (joint_of(robot, std::string("left_") + role).p_MJ.z() +
                joint_of(robot, std::string("right_") + role).p_MJ.z());
}

// --- Scaling

// Share of a servo's stiffness that is left of it beside the moment by which gravity tips a leaning robot on
// one foot: 1 - m g h / k.
double tipping_margin(const BodyMeasures& body, double stiffness) {
  return 1.0 - body.weight_N * body.com_m / stiffness;
}

// Sag of a knee that is bent by a right angle under the robot's weight, in rad.
double softness(const BodyMeasures& body) {
  return body.weight_N * body.limb_m / body.pitch_stiffness_Nm_per_rad;
}

// Length of bent legs, as a share of straight ones, of a robot whose knees are `softer` times as soft as the
// reference's. Its knees bear a shorter lever, so that they sag by at most twice as much as those of the
// reference.
double straighter(double leg_use, double softer) {
  constexpr double kMostSag = 2.0;
  // By hand, 28 November 2026, for DARwIn-OP with mx_28 servos, 4.2 times as soft: with 0.87 to 0.9 it makes
  // good 0.22 m/s of 0.38, with 0.83 0.16 to 0.21 m/s and with 0.95, whose steps are short, 0.16 m/s.
  constexpr double kStraightest = 0.9;
  if (softer <= kMostSag) return leg_use;
  const double sine = std::sqrt(std::max(0.0, 1.0 - leg_use * leg_use)) * kMostSag / softer;
  return std::max(leg_use, std::min(kStraightest, std::sqrt(1.0 - sine * sine)));
}

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
  // Servos and bus answer as late on a larger robot.
  if (key == "plan_age_ms") return 0.0;
  for (const Unit& unit : kUnits) {
    if (key.ends_with(unit.end)) return unit.exponent;
  }
  return 0.0;
}

const double* find(const RobotParameters& parameters, std::string_view key) {
  const auto found = std::ranges::find(
      parameters.settings, key,
      [](const ParameterSetting& setting) -> std::string_view { return setting.name.text; });
  return found == parameters.settings.end() ? nullptr : &found->value;
}

double* find(RobotParameters& parameters, std::string_view key) {
  return const_cast<double*>(find(std::as_const(parameters), key));
}

double find_or(const RobotParameters& parameters, std::string_view key, double otherwise) {
  const double* value = find(parameters, key);
  return value == nullptr ? otherwise : *value;
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

// By the file of the robot, as firmware/behaviour/supply_guard.h defines them; the guard takes all servos as
// of one kind. Whole steps of the parameters.
void set_supply_load(RobotParameters& parameters, const sim_board::RobotDescription& robot) {
  const sim_board::ServoDescription& servo = robot.joints.front().servo;
  const double resistance_ohm = robot.battery ? robot.battery->internal_resistance_ohm : 0.0;
  const double sag_mV = 1e3 * resistance_ohm * servo.supply_V / servo.resistance_ohm;
  const double speed_deg_per_s = kDegreesPerRad * servo.supply_V / servo.torque_constant_Nm_per_A;
  constexpr double kMaxSpeed_deg_per_s = 2'879.0;  // the range of object 2100:06
  set(parameters, "stalled_drive_sag_mV", std::min(std::round(sag_mV), 65'535.0));
  set(parameters, "no_load_speed_deg_per_s", std::min(std::round(speed_deg_per_s), kMaxSpeed_deg_per_s));
}

// Lets the feedback of the lean at the ankles do what stiffer servos would, for robots that gravity tips
// nearly as strongly as their servos hold them.
void stiffen(RobotParameters& parameters, const BodyMeasures& body, const BodyMeasures& from) {
  // A gain of 40 % for a DARwIn-OP with mx_28 servos, a ratio of 1.4, by hand, 28 November 2026: at 0.2 m/s
  // two of four fall without it, and none with it; 80 % is no better.
  constexpr double kLeastRatio = 2.0;
  const double ratio = body.pitch_stiffness_Nm_per_rad / (body.weight_N * body.com_m);
  if (ratio < kLeastRatio) {
    const double gain_percent = 100.0 * std::min(1.0, kLeastRatio / ratio - 1.0);
    set(parameters, "walking_lean_gain_ankle_pitch_percent", gain_percent);
    set(parameters, "standing_lean_gain_ankle_pitch_percent", gain_percent);
  }
  // Servos that sag shorten the steps: told 0.55 m/s, this robot makes good 0.33.
  const double margin = tipping_margin(body, body.pitch_stiffness_Nm_per_rad) /
                        tipping_margin(from, from.pitch_stiffness_Nm_per_rad);
  multiply(parameters, "highest_velocity_forward_mm_per_s", 1.0 / std::sqrt(std::clamp(margin, 0.25, 1.0)));
}

constexpr double kMostCompliance_rad_per_m = 3.0;  // the range of object 0x2131
// Length of bent legs as a share of the straight ones. Above, knees are within 16 degrees of straight, where
// their torque no longer moves the body; below, thigh and shank of most robots meet. By hand.
constexpr double kMostLegUse = 0.99;
constexpr double kLeastLegUse = 0.6;
// Height of the free foot when the weight is over the other one, by the leg's length: more than the loaded
// leg's servos sag, which would leave a part of the weight on the free foot.
constexpr double kFreeFoot = 0.03;

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

// Changes the values that the robot's body refuses. Throws InputError for one that cannot be mended.
void mend_all(RobotParameters& parameters, const BodyMeasures& body, const robot::RobotModel& model) {
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

// Shares of the way by which a CoM is lowered that are tried where the legs do not reach their poses or
// steps: ankles of some robots bend little, and heavy legs bend more for the same CoM height.
constexpr std::array<double, 5> kLoweredShares{1.0, 0.85, 0.7, 0.55, 0.4};

void fit(RobotParameters& parameters, const BodyMeasures& body, const robot::RobotModel& model) {
  const RobotParameters unfitted = parameters;
  const double lowered_m = body.com_m - find_or(parameters, "com_height_mm", 0.0) / kMmPerM;
  std::optional<InputError> first;
  for (const double share : kLoweredShares) {
    parameters = unfitted;
    if (share < 1.0) set(parameters, "com_height_mm", kMmPerM * (body.com_m - share * lowered_m));
    try {
      return mend_all(parameters, body, model);
    } catch (const InputError& error) {
      if (!first) first = error;
    }
    if (lowered_m <= 0.0) break;
  }
  throw InputError(*first);
}

// --- Motions

// The angles of the first pose of the motion `name`, by the names of the joints, in degrees.
std::vector<std::pair<std::string, double>> compiled_angles(const std::string& name, const std::string& text,
                                                            const simulation::NamedModel& model) {
  const simulation::MotionFile file = simulation::read_motion_text(name + ".yaml", text);
  simulation::Diagnostics diagnostics(file.path, file.text);
  const simulation::MotionSource motion = simulation::parse_motion(file, model, diagnostics);
  static_cast<void>(simulation::compile_motion(motion, model, diagnostics));
  diagnostics.throw_errors();
  std::vector<std::pair<std::string, double>> angles;
  const simulation::PoseSource& pose = motion.poses.front();
  for (std::size_t joint = 0; joint < pose.angles.size(); ++joint) {
    if (pose.angles[joint])
      angles.emplace_back(model.joint_names[joint], kDegreesPerRad * fixed::to_double(*pose.angles[joint]));
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

// Returns the text of the deepest squat that the joints reach: knees of some robots end at 110 degrees.
// Throws MotionError, that of the shallowest squat, if there is none.
template <typename TextOfDepth>
std::string deepest_squat(const TextOfDepth& text_of, const simulation::NamedModel& model) {
  constexpr std::array<double, 5> kDepths{0.85, 0.88, 0.91, 0.94, 0.96};  // of the CoM's height
  for (const double depth : kDepths) {
    std::string text = text_of(depth);
    try {
      static_cast<void>(compiled_angles("squat", text, model));
      return text;
    } catch (const simulation::MotionError&) {
      if (depth == kDepths.back()) throw;
    }
  }
  return {};
}

// Returns the text of the shift that goes farthest over each foot: hips of some robots hardly turn inwards,
// and the centre of mass then stays on the inner part of the sole, of which `half_sole_m` is the width.
// Throws MotionError, that of the shift to the middle of the sole, if there is none.
template <typename TextOfShift>
std::string farthest_shift(const TextOfShift& text_of, double half_sole_m,
                           const simulation::NamedModel& model) {
  constexpr std::array<double, 4> kInward{0.0, 0.15, 0.3, 0.45};  // of the half sole
  for (const double inward : kInward) {
    std::string text = text_of(inward * half_sole_m);
    try {
      static_cast<void>(compiled_angles("shift", text, model));
      return text;
    } catch (const simulation::MotionError&) {
    }
  }
  static_cast<void>(compiled_angles("shift", text_of(0.0), model));
  return {};
}

// Makes the standing pose at a height, and the motions from it.
class PoseMaker {
 public:
  PoseMaker(const StartValues& values, const simulation::NamedModel& model, const std::string& origin)
      : values_(values),
        model_(model),
        origin_(origin),
        step_s_(1.5 * std::max(1.0, values.time_scale)),
        time_(fmt::format("{:.2f}", step_s_)) {}

  // Throws MotionError for a pose that the legs do not reach; motions that they do not reach are `unreached`.
  StandingPose make(double height_m) const {
    const std::string pose =
        pose_text("stand", "hanging", values_.com_forward_m, height_m, values_.step_width_m) +
        hanging_text(model_);
    StandingPose standing{.stand_text = motion_head(values_, "stand", origin_) + pose +
                                        "steps:\n  - {pose: stand, time_s: " + time_ + "}\n",
                          .squat_text = {},
                          .shift_text = {},
                          .joints_text = {},
                          .joints_deg = {},
                          .step_s = step_s_,
                          .unreached = {}};
    standing.joints_deg = compiled_angles("stand", standing.stand_text, model_);
    for (const auto& [joint, angle_deg] : standing.joints_deg)
      standing.joints_text +=
          fmt::format("{}{}: {:.2f}", standing.joints_text.empty() ? "" : ", ", joint, angle_deg);
    const auto attempt = [&standing](const char* motion, std::string& text, const auto& make_text) {
      try {
        text = make_text();
      } catch (const simulation::MotionError& error) {
        standing.unreached[motion] = error.what();
      }
    };
    attempt("squat", standing.squat_text, [&] { return squat_text(pose, height_m); });
    attempt("shift", standing.shift_text, [&] { return shift_text(pose); });
    return standing;
  }

 private:
  std::string squat_text(const std::string& pose, double height_m) const {
    return deepest_squat(
        [&](double depth) {
          return motion_head(values_, "squat", origin_) + pose +
                 pose_text("down", "stand", values_.com_forward_m, depth * height_m, values_.step_width_m) +
                 fmt::format(
                     "steps:\n  - {{pose: stand, time_s: {0}}}\n  - loop:\n      times: 3\n      steps:\n"
                     "        - {{pose: down, time_s: {0}, interpolation: minimum_jerk}}\n"
                     "        - {{pose: stand, time_s: {0}, interpolation: minimum_jerk}}\n",
                     time_);
        },
        model_);
  }

  std::string shift_text(const std::string& pose) const {
    return farthest_shift(
        [&](double inward_m) {
          return motion_head(values_, "shift", origin_) + pose +
                 fmt::format(
                     "  over_left: {{from: stand, support: left, com: {{y_mm: {2:.1f}}}, right_foot: "
                     "{{z_mm: {1:.1f}}}}}\n"
                     "  over_right: {{from: stand, support: right, com: {{y_mm: {3:.1f}}}, left_foot: "
                     "{{z_mm: {1:.1f}}}}}\n"
                     "steps:\n  - {{pose: stand, time_s: {0}}}\n"
                     "  - {{pose: over_left, time_s: {0}, interpolation: minimum_jerk, pause_s: 1}}\n"
                     "  - {{pose: over_right, time_s: {0}, interpolation: minimum_jerk, pause_s: 1}}\n"
                     "  - {{pose: stand, time_s: {0}, interpolation: minimum_jerk}}\n",
                     time_, kMmPerM * kFreeFoot * values_.leg_m, 0.0 - kMmPerM * inward_m,
                     kMmPerM * inward_m);
        },
        0.5 * values_.sole_width_m, model_);
  }

  const StartValues& values_;
  const simulation::NamedModel& model_;
  const std::string& origin_;
  double step_s_;
  std::string time_;
};

// Sets a CoM height and what follows from it.
void set_com_height(StartValues& values, const BodyMeasures& body, double height_m) {
  values.com_height_m = height_m;
  values.com_lowered_m = body.com_m - height_m;
  values.leg_use = (body.limb_m - values.com_lowered_m) / body.limb_m;
}

// Narrows the steps, and then straightens the legs, until they reach the standing pose, its squat and the
// shifts of the weight: hips that are far apart do not reach as far to the side as those of the reference.
// Values of which none is reached stay as they are.
void fit_stance(StartValues& values, const BodyMeasures& body, const simulation::NamedModel& model) {
  constexpr std::array<double, 5> kNarrower{1.0, 0.9, 0.8, 0.7, 0.6};
  const StartValues unfitted = values;
  const double least_m = values.value("narrowest_step_mm") / kMmPerM;
  const auto is_reached = [&](double lowered, double narrower, bool with_all) {
    values = unfitted;
    values.step_width_m = std::max(narrower * unfitted.step_width_m, least_m);
    if (narrower < 1.0) set(values.parameters, "step_width_mm", kMmPerM * values.step_width_m);
    try {
      if (lowered < 1.0) {
        set_com_height(values, body, body.com_m - lowered * unfitted.com_lowered_m);
        set(values.parameters, "com_height_mm", kMmPerM * values.com_height_m);
      }
      if (lowered < 1.0 || narrower < 1.0) mend_all(values.parameters, body, model.model);
      return standing_pose(values, model, "A trial").unreached.empty() || !with_all;
    } catch (const InputError&) {
      return false;
    }
  };
  // A robot that reaches no squat or no shift may stand.
  for (const bool with_all : {true, false})
    for (const double lowered : kLoweredShares)
      for (const double narrower : kNarrower)
        if (is_reached(lowered, narrower, with_all)) return;
  values = unfitted;
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
  body.limb_m = mean_z(robot, "hip_pitch") - mean_z(robot, "ankle_pitch");
  body.com_m = (X_MW * tree.centre_of_mass(X_WLs)).z() - sole_z_m;
  body.stance_m = left.translation().y() - right.translation().y();
  body.sole_width_m = other_inner_m - inner_m;
  body.sole_middle_m = 0.5 * (front_m + back_m);
  body.weight_N = robot.total_mass_kg() * sim_board::kGravity_m_per_s2;
  body.pitch_stiffness_Nm_per_rad =
      weakest_Nm_per_rad(robot, {"left_hip_pitch", "left_knee", "left_ankle_pitch"});
  body.roll_stiffness_Nm_per_rad = weakest_Nm_per_rad(robot, {"left_hip_roll", "left_ankle_roll"});
  body.supply_V = robot.battery ? robot.battery->open_circuit_V : robot.joints.front().servo.supply_V;
  if (body.leg_m < 0.02 || body.limb_m < 0.01 || body.com_m < 0.02)
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
  set_supply_load(parameters, robot);
  // The plan follows arms and waist; only the reference was tuned without.
  set(parameters, "fixed_upper_body", 0.0);
  set(parameters, "touchdown_load_N", 0.0);
  // Legs that stand far apart walk on a narrower track: the sway of the body from foot to foot grows with its
  // width. 1.14 walks.
  constexpr double kMostStance = 1.2;
  const double stance = std::min(kMostStance, body.stance_m / from.stance_m / scale);
  multiply(parameters, "step_width_mm", stance);
  multiply(parameters, "widest_step_mm", stance);
  set(parameters, "narrowest_step_mm", kMmPerM * body.sole_width_m + 2.0 * scale);
  const double lowered_m = from.com_m - *find(reference, "com_height_mm") / kMmPerM;
  const double leg_use = straighter(1.0 - lowered_m / from.limb_m, softness(body) / softness(from));
  set(parameters, "com_height_mm",
      kMmPerM * (body.com_m - (1.0 - leg_use) * body.limb_m) * factors.com_height);
  multiply(parameters, "step_time_ms", factors.step_time);
  // The ZMP keeps its place in the sole, which need not be below the ankle.
  set(parameters, "zmp_forward_mm",
      kMmPerM * (body.sole_middle_m - scale * from.sole_middle_m) +
          scale * find_or(reference, "zmp_forward_mm", kMmPerM * from.sole_middle_m));
  // A servo sags by torque over stiffness, and the torque is the weight times the lever, which is the
  // parameter's metre. The scaling by length above does not apply. An error of the compensation (of masses or
  // gains, a tenth in the world `mild`) lets the robot lean, and the lean is amplified by 1 / tipping margin.
  // The compensation is reduced by this margin, which keeps the error of the lean: a DARwIn-OP with mx_28
  // servos (margin 0.36) falls with the full compensation, 3 rad/m, and walks with 0.8 to 2.2 rad/m
  // (27 November 2026). The walk that closes its loop steps where the lean wants it, and the compensation in
  // pitch then counts twice, so that the margin is squared: of 0.38 m/s the same robot makes good 0.07 m/s
  // with 2.2 rad/m, 0.22 with 1.36 and 0.28 with 0.4; with 0 one of four falls (28 November 2026).
  const auto sag = [&](const char* key, double BodyMeasures::*stiffness, double power) {
    const double* tuned = find(reference, key);
    if (tuned == nullptr) return;
    const double margin = tipping_margin(body, body.*stiffness) / tipping_margin(from, from.*stiffness);
    const double compliance = *tuned * (body.weight_N / from.weight_N) /
                              (body.*stiffness / (from.*stiffness)) * std::pow(std::max(0.0, margin), power);
    set(parameters, key, std::clamp(compliance, 0.0, kMostCompliance_rad_per_m));
  };
  sag("pitch_compliance_rad_per_m", &BodyMeasures::pitch_stiffness_Nm_per_rad, 2.0);
  sag("roll_compliance_rad_per_m", &BodyMeasures::roll_stiffness_Nm_per_rad, 1.0);
  stiffen(parameters, body, from);
  for (ParameterSetting& setting : parameters.settings) {
    if (setting.name.text.starts_with("walking_")) setting.value *= factors.gains;
  }
  if (double* pitch = find(parameters, "trunk_pitch_deg")) *pitch += factors.trunk_pitch_deg;
  fit(parameters, body, model.model);
  set_com_height(values, body, *find(parameters, "com_height_mm") / kMmPerM);
  values.step_width_m = *find(parameters, "step_width_mm") / kMmPerM;
  values.com_forward_m = body.sole_middle_m;
  values.leg_m = body.leg_m;
  values.sole_width_m = body.sole_width_m;
  if (values.leg_use > kMostLegUse || values.leg_use < kLeastLegUse)
    throw InputError(
        parameters.file, 0,
        fmt::format("a CoM height of {:.0f} mm, for which legs of {:.0f} mm would be {:.0f} mm long",
                    kMmPerM * values.com_height_m, kMmPerM * body.limb_m,
                    kMmPerM * values.leg_use * body.limb_m),
        fmt::format("{:.0f} to {:.0f} mm", kMmPerM * (body.com_m - (1 - kLeastLegUse) * body.limb_m),
                    kMmPerM * (body.com_m - (1 - kMostLegUse) * body.limb_m)));
  fit_stance(values, body, model);
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
  constexpr int kMostChanges = 20;
  // The reason that keeps the robot from its own height, not from the lowest one.
  std::string first_fault;
  for (const bool with_all : {true, false}) {
    double height_m = values.com_height_m;
    for (int change = 0; change <= kMostChanges; ++change, height_m *= 0.98) {
      try {
        StandingPose standing = PoseMaker(values, model, origin).make(height_m);
        if (standing.unreached.empty() || !with_all) return standing;
        if (first_fault.empty()) first_fault = standing.unreached.begin()->second;
      } catch (const simulation::MotionError& error) {
        if (first_fault.empty()) first_fault = error.what();
      }
    }
  }
  throw InputError("stand.yaml", 0, first_fault, "a standing pose that the legs reach");
}

}  // namespace koboshi::lab
