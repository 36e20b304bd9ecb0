#include "lab/bring_up/recovery_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text/error.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/parse.h"
#include "tools/motion_files/flatten.h"
#include "tools/motion_files/retarget.h"

namespace koboshi::lab {
namespace {

using Kind = simulation::StepSource::Kind;

constexpr double kUsableSpeed = 0.9;  // of a servo's speed without load; a loaded one is slower
constexpr double kTimeFactor = 2.0;   // by which a search changes a time at most
constexpr double kShortest_s = 0.03;  // three ticks

// The roles that a search changes, and by how much. Angles of the legs decide where the feet are, so that
// they have the smaller range.
constexpr std::array<std::pair<const char*, double>, 6> kReaches_deg{{{"hip_pitch", 30.0},
                                                                      {"knee", 30.0},
                                                                      {"ankle_pitch", 30.0},
                                                                      {"shoulder_pitch", 45.0},
                                                                      {"shoulder_roll", 20.0},
                                                                      {"elbow", 45.0}}};

// 1 for a joint whose positive angles turn the lower end backward.
double pitch_sign(const sim_board::RobotDescription& robot, std::size_t joint) {
  return robot.joints[joint].axis_M.y() < 0.0 ? -1.0 : 1.0;
}

// Length of the left thigh as a share of that of the shank; 1 for a robot without knees.
double thigh_share_of(const sim_board::RobotDescription& robot) {
  const auto hip = robot.find_joint("left_hip_pitch");
  const auto knee = robot.find_joint("left_knee");
  const auto ankle = robot.find_joint("left_ankle_pitch");
  if (!hip || !knee || !ankle) return 1.0;
  const auto anchor = [&](int joint) { return robot.joints[static_cast<std::size_t>(joint)].p_MJ; };
  return (anchor(*hip) - anchor(*knee)).norm() / std::max(1e-3, (anchor(*knee) - anchor(*ankle)).norm());
}

// The angle by which the line from ankle to hip leans back from the shank, for a knee.
double leg_angle_deg(double knee_deg, double thigh_share) {
  const double knee_rad = knee_deg / kDegreesPerRad;
  return kDegreesPerRad *
         std::atan2(thigh_share * std::sin(knee_rad), 1.0 + thigh_share * std::cos(knee_rad));
}

}  // namespace

RecoveryMotion RecoveryMotion::retarget(const std::string& name, const std::filesystem::path& from,
                                        const sim_board::RobotDescription& to,
                                        std::span<const std::pair<std::string, double>> standing_deg,
                                        double time_scale) {
  const std::filesystem::path gentler = from.parent_path() / "bring_up" / (name + ".yaml");
  const std::filesystem::path file =
      std::filesystem::exists(gentler) ? gentler : from.parent_path() / "motions" / (name + ".yaml");
  const sim_board::RobotDescription from_robot = sim_board::load_robot(from);
  const simulation::NamedModel from_model = simulation::load_named_model(from_robot);
  const simulation::MotionSource source = simulation::parse_motion(file, from_model);
  const tools::JointMap map =
      tools::retarget_joints(file, tools::flatten_motion(source, from_model), from_robot, to);
  RecoveryMotion motion(name, to);
  for (const tools::ForeignNote& note : map.notes) motion.notes_.push_back(note.text);
  for (const simulation::PoseSource& pose : source.poses) {
    Pose mapped{.name = pose.name, .angles_deg = {}};
    if (pose.name == "stand") {
      for (const auto& [joint, angle_deg] : standing_deg)
        mapped.angles_deg[static_cast<std::size_t>(*to.find_joint(joint))] = angle_deg;
    }
    for (std::size_t i = 0; pose.name != "stand" && i < pose.angles.size(); ++i) {
      if (!pose.angles[i] || !map.joints[i]) continue;
      const tools::MappedJoint& joint = *map.joints[i];
      mapped.angles_deg[joint.joint] = joint.sign * kDegreesPerRad * fixed::to_double(*pose.angles[i]);
    }
    motion.poses_.push_back(std::move(mapped));
  }
  for (const simulation::StepSource& step : source.steps) {
    if (step.kind == Kind::kMove && step.speed_raw == 0) {
      // Nobody knows where the first move begins.
      motion.steps_.push_back({.pose = step.pose,
                               .time_s = 1e-6 * time_scale * step.time_us,
                               .at_least = step.at_least || motion.steps_.empty()});
    } else if (step.kind == Kind::kExpect) {
      const motion::ExpectedAttitude& up = step.attitude;
      motion.steps_.push_back({.text = fmt::format("{{expect: {{up: [{}, {}, {}], min_cosine: {}}}}}",
                                                   up.up_B[0], up.up_B[1], up.up_B[2], up.min_cosine)});
    } else {
      throw InputError(file, step.place.line, "a step that is neither a move with a time nor `expect`",
                       "a motion of moves and expected attitudes");
    }
  }
  motion.fit_legs(thigh_share_of(from_robot));
  motion.slow_down();
  return motion;
}

RecoveryMotion RecoveryMotion::over_the_side(const RecoveryMotion& rise_prone) {
  // By hand, 28 November 2026, for Sigmaban. Arm and leg then point behind the trunk.
  constexpr double kArm_deg = 110.0;
  constexpr double kLeg_deg = 60.0;
  constexpr double kPush_s = 0.5;
  constexpr double kRoll_s = 0.5;
  const sim_board::RobotDescription& robot = *rise_prone.robot_;
  RecoveryMotion motion("rise_supine", robot);
  motion.notes_ = rise_prone.notes_;
  motion.how_ = "over the side to the chest, and then as rise_prone";
  Pose flat{.name = "flat", .angles_deg = {}};
  Pose push{.name = "push_over", .angles_deg = {}};
  Pose level{.name = "level", .angles_deg = {}};
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint)
    flat.angles_deg[joint] = motion.clamped_deg(joint, 0.0);
  for (const auto& [role, angle_deg] :
       {std::pair("right_shoulder_pitch", kArm_deg), std::pair("right_hip_pitch", kLeg_deg)}) {
    const auto joint = robot.find_joint(role);
    if (!joint) continue;
    const auto index = static_cast<std::size_t>(*joint);
    push.angles_deg[index] = motion.clamped_deg(index, pitch_sign(robot, index) * angle_deg);
    level.angles_deg[index] = motion.clamped_deg(index, 0.0);
  }
  motion.poses_ = {flat, push, level};
  motion.steps_ = {{.pose = 0, .time_s = kPush_s, .at_least = true},
                   {.text = "{expect: {pitch_deg: -90, within_deg: 50}}"},
                   {.pose = 1, .time_s = kPush_s},
                   {.pose = 1, .time_s = kRoll_s},
                   {.pose = 2, .time_s = kPush_s}};
  const std::size_t poses = motion.poses_.size();
  motion.poses_.insert(motion.poses_.end(), rise_prone.poses_.begin(), rise_prone.poses_.end());
  for (Step step : rise_prone.steps_) {
    if (step.pose) *step.pose += poses;
    motion.steps_.push_back(std::move(step));
  }
  motion.slow_down();
  return motion;
}

// Follows the legs through the steps, because a pose need not name all of their joints.
void RecoveryMotion::fit_legs(double thigh_share) {
  const double other_share = thigh_share_of(*robot_);
  for (const char* side : {"left_", "right_"}) {
    const std::array<std::optional<int>, 3> found{robot_->find_joint(side + std::string("hip_pitch")),
                                                  robot_->find_joint(side + std::string("knee")),
                                                  robot_->find_joint(side + std::string("ankle_pitch"))};
    if (!found[0] || !found[1] || !found[2]) continue;
    std::array<std::size_t, 3> joints{};
    std::array<double, 3> signs{};
    for (std::size_t i = 0; i < 3; ++i) {
      joints[i] = static_cast<std::size_t>(*found[i]);
      signs[i] = pitch_sign(*robot_, joints[i]);
    }
    std::array<double, 3> leg_deg{};  // of the first robot: hip, knee, ankle; forward and up negative
    bool was_fitted = false;
    for (const Step& step : steps_) {
      if (!step.pose) continue;
      std::map<std::size_t, double>& angles = poses_[*step.pose].angles_deg;
      bool is_named = false;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto angle = angles.find(joints[i]);
        if (angle == angles.end()) continue;
        leg_deg[i] = signs[i] * angle->second;
        is_named = true;
      }
      if (!is_named) continue;
      const double knee_deg = signs[1] * clamped_deg(joints[1], signs[1] * leg_deg[1]);
      const bool is_fitted = std::abs(knee_deg - leg_deg[1]) > 1.0;
      if (is_fitted) {
        const double ankle_deg =
            leg_deg[2] + leg_angle_deg(leg_deg[1], thigh_share) - leg_angle_deg(knee_deg, other_share);
        const double lean_deg = leg_deg[0] + leg_deg[1] + leg_deg[2];
        angles[joints[0]] = signs[0] * (lean_deg - knee_deg - ankle_deg);
        angles[joints[1]] = signs[1] * knee_deg;
        angles[joints[2]] = signs[2] * ankle_deg;
      } else if (was_fitted) {
        for (std::size_t i = 0; i < 3; ++i) angles[joints[i]] = signs[i] * leg_deg[i];
      }
      was_fitted = is_fitted;
    }
  }
  for (Pose& pose : poses_)
    for (auto& [joint, angle_deg] : pose.angles_deg) angle_deg = clamped_deg(joint, angle_deg);
}

RecoveryMotion RecoveryMotion::with_rolls(double factor) const {
  constexpr double kSpread_deg = 15.0;  // legs that are parted on purpose
  RecoveryMotion motion = *this;
  for (std::size_t i = 0; i + 1 < poses_.size(); ++i) {
    for (const char* role : {"hip_roll", "ankle_roll"}) {
      for (const sim_board::MirroredJoint& mirrored : robot_->find_joints(role)) {
        const auto angle = motion.poses_[i].angles_deg.find(static_cast<std::size_t>(mirrored.joint));
        if (angle == motion.poses_[i].angles_deg.end() || std::abs(angle->second) > kSpread_deg) continue;
        angle->second = clamped_deg(angle->first, factor * angle->second);
      }
    }
  }
  return motion;
}

RecoveryMotion RecoveryMotion::with_less_flexion(double by_deg) const {
  RecoveryMotion motion = *this;
  for (const sim_board::MirroredJoint& mirrored : robot_->find_joints("hip_pitch")) {
    const auto joint = static_cast<std::size_t>(mirrored.joint);
    const double sign = pitch_sign(*robot_, joint);
    double most_deg = 0.0;
    for (const Pose& pose : poses_)
      if (const auto angle = pose.angles_deg.find(joint); angle != pose.angles_deg.end())
        most_deg = std::min(most_deg, sign * angle->second);
    for (std::size_t i = 0; i + 1 < poses_.size(); ++i)
      if (const auto angle = motion.poses_[i].angles_deg.find(joint);
          angle != motion.poses_[i].angles_deg.end())
        angle->second = sign * std::max(sign * angle->second, most_deg + by_deg);
  }
  return motion;
}

RecoveryMotion RecoveryMotion::with_times(double factor) const {
  RecoveryMotion motion = *this;
  for (Step& step : motion.steps_) step.time_s *= factor;
  motion.slow_down();
  return motion;
}

RecoveryMotion RecoveryMotion::with_step_slower_by(std::size_t step, double factor) const {
  RecoveryMotion motion = *this;
  motion.steps_[step].time_s *= factor;
  return motion;
}

std::optional<std::size_t> RecoveryMotion::step_of_line(int line) const {
  // As text() writes them: a comment, four keys, the poses, `steps` and the steps.
  const int first = 5 + static_cast<int>(poses_.size()) + 2;
  if (line < first || line >= first + static_cast<int>(steps_.size())) return std::nullopt;
  return static_cast<std::size_t>(line - first);
}

double RecoveryMotion::clamped_deg(std::size_t joint, double angle_deg) const {
  // The motion language refuses an angle beyond a limit, also by its rounding.
  constexpr double kRounding_deg = 0.02;
  const sim_board::JointDescription& limits = robot_->joints[joint];
  return std::clamp(angle_deg, kDegreesPerRad * limits.lower_rad + kRounding_deg,
                    kDegreesPerRad * limits.upper_rad - kRounding_deg);
}

void RecoveryMotion::slow_down() {
  std::map<std::size_t, double> last_deg;
  for (Step& step : steps_) {
    if (!step.pose) continue;
    for (const auto& [joint, angle_deg] : poses_[*step.pose].angles_deg) {
      const auto before = last_deg.find(joint);
      if (before != last_deg.end()) {
        const double turn_rad = std::abs(angle_deg - before->second) / kDegreesPerRad;
        step.time_s =
            std::max(step.time_s, turn_rad / (kUsableSpeed * robot_->joints[joint].max_speed_rad_per_s));
      }
      last_deg[joint] = angle_deg;
    }
    step.time_s = std::max(step.time_s, kShortest_s);
  }
}

std::vector<RecoveryMotion::Variable> RecoveryMotion::variables() const {
  const auto expected = std::ranges::find_if(steps_, [](const Step& step) { return !step.pose; });
  if (expected == steps_.end()) return {};
  std::vector<Variable> variables;
  for (auto step = expected; step != steps_.end(); ++step) {
    if (!step->pose) continue;
    variables.push_back({static_cast<std::size_t>(step - steps_.begin()), {}, kTimeFactor});
    if (step + 1 == steps_.end()) continue;  // the standing pose stays
    for (const auto& [role, reach_deg] : kReaches_deg) {
      const auto joints = robot_->find_joints(role);
      if (std::ranges::any_of(joints, [&](const sim_board::MirroredJoint& mirrored) {
            return poses_[*step->pose].angles_deg.contains(static_cast<std::size_t>(mirrored.joint));
          }))
        variables.push_back({*step->pose, role, reach_deg});
    }
  }
  return variables;
}

RecoveryMotion RecoveryMotion::with(std::span<const Variable> variables, std::span<const double> x) const {
  RecoveryMotion motion = *this;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const Variable& variable = variables[i];
    const double change = 2.0 * x[i] - 1.0;
    if (variable.role.empty()) {
      motion.steps_[variable.pose].time_s *= std::pow(variable.reach, change);
      continue;
    }
    for (const sim_board::MirroredJoint& mirrored : robot_->find_joints(variable.role)) {
      const auto joint = static_cast<std::size_t>(mirrored.joint);
      const auto angle = motion.poses_[variable.pose].angles_deg.find(joint);
      if (angle == motion.poses_[variable.pose].angles_deg.end()) continue;  // of one side only
      angle->second = clamped_deg(joint, angle->second + mirrored.sign * change * variable.reach);
    }
  }
  motion.slow_down();
  return motion;
}

std::string RecoveryMotion::text(const std::string& origin) const {
  std::string text = fmt::format("# {}: {}, {}.\nversion: 2\nrobot: {}\nname: {}\nposes:\n", origin, name_,
                                 how_, robot_->name, name_);
  for (const Pose& pose : poses_) {
    std::string angles;
    for (const auto& [joint, angle_deg] : pose.angles_deg)
      angles += fmt::format("{}{}: {:.2f}", angles.empty() ? "" : ", ", robot_->joints[joint].name,
                            angle_deg + 0.0);
    text += fmt::format("  {}: {{{}}}\n", pose.name, angles);
  }
  text += "steps:\n";
  for (const Step& step : steps_) {
    text += step.pose
                ? fmt::format("  - {{pose: {}, {}: {:.3f}}}\n", poses_[*step.pose].name,
                              step.at_least ? "at_least_s" : "time_s", std::ceil(1e3 * step.time_s) / 1e3)
                : fmt::format("  - {}\n", step.text);
  }
  return text;
}

}  // namespace koboshi::lab
