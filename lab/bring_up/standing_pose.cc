#include "lab/bring_up/standing_pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/text/error.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/parse.h"

namespace koboshi::lab {
namespace {

// Height of the free foot when the weight is over the other one, by the leg's length: more than the loaded
// leg's servos sag, which would leave a part of the weight on the free foot.
constexpr double kFreeFoot = 0.03;

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

}  // namespace

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
  throw InputError(values.robot_file, 0, first_fault, "a standing pose that the legs reach");
}

}  // namespace koboshi::lab
