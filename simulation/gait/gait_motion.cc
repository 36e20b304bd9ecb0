#include "simulation/gait/gait_motion.h"

#include <cmath>

#include <fmt/core.h>

#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/gait/walking_pose.h"

namespace koboshi::simulation {
namespace {
// Angles are rounded to the resolution of a motion file, so that file and source give the same motion.
constexpr double kWritten_deg = 1e-3;
constexpr std::uint32_t kStand_us = 500'000;

class MotionMaker {
 public:
  MotionMaker(const Gait& gait, const sim_board::RobotDescription& robot, const NamedModel& model)
      : gait_(gait), plan_(gait), pose_(gait, robot, model), model_(model) {}

  MotionSource make() {
    motion_.file = gait_.file;
    motion_.name = "walk";
    motion_.steps.push_back(move("stand", plan_.at(0.0), kStand_us));
    add_points(motion_.steps, "start", 0.0, plan_.start_s(), [&](double t) { return plan_.at(t); });
    StepSource cycle;
    cycle.kind = StepSource::Kind::kLoop;
    add_points(cycle.body, "walk", plan_.start_s(), plan_.cycle_s(), [&](double t) { return plan_.at(t); });
    motion_.steps.push_back(std::move(cycle));
    add_points(motion_.steps, "stop", 0.0, plan_.stop_s(), [&](double t) { return plan_.at_stop(t); });
    return std::move(motion_);
  }

 private:
  // Adds moves over [begin, begin + duration], each to a point of the plan; the last move ends with the
  // interval.
  template <typename At>
  void add_points(std::vector<StepSource>& steps, const std::string& name, double begin_s, double duration_s,
                  At&& at) {
    const double interval_s = gait_.period_s / gait_.points;
    const int count = static_cast<int>(std::lround(duration_s / interval_s));
    std::uint32_t done_us = 0;
    for (int i = 1; i <= count; ++i) {
      const double end_s = duration_s * i / count;
      const auto end_us = static_cast<std::uint32_t>(std::lround(end_s * 1e6));
      steps.push_back(move(fmt::format("{}_{}", name, i), at(begin_s + end_s), end_us - done_us));
      done_us = end_us;
    }
  }

  StepSource move(const std::string& name, const GaitInstant& instant, std::uint32_t time_us) {
    PoseSource pose{.name = name};
    const std::vector<double> targets_rad = pose_.targets_rad(instant);
    for (std::size_t joint = 0; joint < targets_rad.size(); ++joint) {
      const double angle_deg = std::round(targets_rad[joint] / kRadPerDegree / kWritten_deg) * kWritten_deg;
      pose.angles.emplace_back(robot::clamp_to_limits(
          model_.model.joints[joint], fixed::from_double<fixed::Angle>(angle_deg * kRadPerDegree)));
    }
    motion_.poses.push_back(std::move(pose));
    StepSource step;
    step.kind = StepSource::Kind::kMove;
    step.pose = motion_.poses.size() - 1;
    step.time_us = time_us;
    return step;
  }

  const Gait& gait_;
  const GaitPlan plan_;
  const WalkingPose pose_;
  const NamedModel& model_;
  MotionSource motion_;
};

void write_steps(std::string& text, const MotionSource& motion, const std::vector<StepSource>& steps,
                 const std::string& indent) {
  for (const StepSource& step : steps) {
    if (step.kind == StepSource::Kind::kLoop) {
      text += fmt::format("{0}- loop:\n{0}    until: stopped\n{0}    steps:\n", indent);
      write_steps(text, motion, step.body, indent + "      ");
    } else {
      text += fmt::format("{}- {{pose: {}, time_s: {}}}\n", indent, motion.poses[step.pose].name,
                          step.time_us * 1e-6);
    }
  }
}

}  // namespace

MotionSource make_gait_motion(const Gait& gait, const sim_board::RobotDescription& robot,
                              const NamedModel& model) {
  return MotionMaker(gait, robot, model).make();
}

std::string gait_motion_text(const MotionSource& motion, const NamedModel& model) {
  std::string text = fmt::format("version: 1\nrobot: {}\nname: {}\nposes:\n", model.robot, motion.name);
  for (const PoseSource& pose : motion.poses) {
    text += fmt::format("  {}:", pose.name);
    for (std::size_t joint = 0; joint < pose.angles.size(); ++joint) {
      const double angle_deg = fixed::to_double(*pose.angles[joint]) / kRadPerDegree;
      text += fmt::format("{} {}: {:.3f}", joint == 0 ? " {" : ",", model.joint_names[joint], angle_deg);
    }
    text += "}\n";
  }
  text += "steps:\n";
  write_steps(text, motion, motion.steps, "  ");
  return text;
}

}  // namespace koboshi::simulation
