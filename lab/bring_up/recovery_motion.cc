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

}  // namespace

RecoveryMotion RecoveryMotion::retarget(const std::string& name, const std::filesystem::path& from,
                                        const sim_board::RobotDescription& to,
                                        std::span<const std::pair<std::string, double>> standing_deg,
                                        double time_scale) {
  const std::filesystem::path file = from.parent_path() / "motions" / (name + ".yaml");
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
      mapped.angles_deg[joint.joint] =
          motion.clamped_deg(joint.joint, joint.sign * kDegreesPerRad * fixed::to_double(*pose.angles[i]));
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
  motion.slow_down();
  return motion;
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
      if (joints.empty()) continue;
      if (poses_[*step->pose].angles_deg.contains(static_cast<std::size_t>(joints.front().joint)))
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
      double& angle_deg = motion.poses_[variable.pose].angles_deg[joint];
      angle_deg = clamped_deg(joint, angle_deg + mirrored.sign * change * variable.reach);
    }
  }
  motion.slow_down();
  return motion;
}

std::string RecoveryMotion::text(const std::string& origin) const {
  std::string text = fmt::format(
      "# {}: {}, from that of the reference robot by the roles of the joints.\nversion: 2\nrobot: "
      "{}\nname: {}\nposes:\n",
      origin, name_, robot_->name, name_);
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
