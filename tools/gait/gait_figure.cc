#include "tools/gait/gait_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/gait/gait_motion.h"
#include "simulation/gait/gait_plan.h"
#include "simulation/gait/walking_pose.h"
#include "tools/plot/figure.h"
#include "tools/plot/legend.h"

namespace koboshi::tools {
namespace {

constexpr double kSample_s = 0.002;
constexpr int kCycles = 2;
constexpr int kDigits = 7;  // of the numbers in the CSV file

struct ShownJoint {
  robot::JointRole role;
  const char* column;
  const char* label;
};
constexpr std::array<ShownJoint, 4> kShown{
    {{robot::JointRole::kLeftHipPitch, "hip_pitch", "left hip pitch"},
     {robot::JointRole::kLeftKnee, "knee", "left knee"},
     {robot::JointRole::kLeftHipRoll, "hip_roll", "left hip roll"},
     {robot::JointRole::kLeftAnklePitch, "ankle_pitch", "left ankle pitch"}}};

// The joint angles between the poses of a motion, as the firmware's interpreter interpolates them.
class Approximation {
 public:
  explicit Approximation(const simulation::MotionSource& motion) : motion_(motion) {
    points_.push_back({0.0, motion.steps.front().pose});
    bool cycles_done = false;
    for (std::size_t i = 1; i < motion.steps.size() && !cycles_done; ++i) {
      cycles_done = motion.steps[i].kind == simulation::StepSource::Kind::kLoop;
      if (!cycles_done) add(motion.steps[i]);
      for (int cycle = 0; cycles_done && cycle < kCycles; ++cycle) {
        for (const simulation::StepSource& step : motion.steps[i].body) add(step);
      }
    }
  }

  double end_s() const { return points_.back().time_s; }
  double angle_rad(std::size_t joint, double time_s) const {
    const auto to = std::find_if(points_.begin() + 1, points_.end() - 1,
                                 [&](const TimedPose& point) { return point.time_s >= time_s; });
    const auto from = std::prev(to);
    const double share = (time_s - from->time_s) / (to->time_s - from->time_s);
    return std::lerp(angle_of(*from, joint), angle_of(*to, joint), share);
  }

 private:
  struct TimedPose {
    double time_s;
    std::size_t pose;
  };

  void add(const simulation::StepSource& step) {
    points_.push_back({end_s() + 1e-6 * step.time_us, step.pose});
  }
  double angle_of(const TimedPose& point, std::size_t joint) const {
    return fixed::to_double(*motion_.poses[point.pose].angles[joint]);
  }

  const simulation::MotionSource& motion_;
  std::vector<TimedPose> points_;
};

Columns profile_of(const simulation::Gait& gait, const sim_board::RobotDescription& robot,
                   const simulation::NamedModel& model) {
  const simulation::GaitPlan plan(gait);
  const simulation::WalkingPose pose(gait, robot, model);
  const simulation::MotionSource motion = simulation::make_gait_motion(gait, robot, model);
  const Approximation approximation(motion);
  Columns columns = make_columns({"time_s", "com_x_m", "com_y_m", "zmp_x_m", "zmp_y_m"});
  for (const ShownJoint& joint : kShown) {
    columns.push_back({std::string(joint.column) + "_rad", {}});
    columns.push_back({std::string(joint.column) + "_points_rad", {}});
  }
  const int samples = static_cast<int>(std::lround(approximation.end_s() / kSample_s));
  for (int i = 0; i <= samples; ++i) {
    const double time_s = i * kSample_s;
    const simulation::GaitInstant instant = plan.at(time_s);
    const std::vector<double> targets_rad = pose.targets_rad(instant);
    std::vector<double> row{time_s, instant.com_W_m.x(), instant.com_W_m.y(), instant.zmp_W_m.x(),
                            instant.zmp_W_m.y()};
    for (const ShownJoint& joint : kShown) {
      const std::size_t index = *model.model.find(joint.role);
      row.push_back(targets_rad[index]);
      row.push_back(approximation.angle_rad(index, time_s));
    }
    add_row(columns, row);
  }
  return columns;
}

Panel pendulum_panel(const std::string& axis, const std::string& label) {
  return {.y_label = label + " [mm]",
          .series = {series(Role::kFirst, "com_" + axis + "_m", "centre of mass", kMmPerM),
                     series(Role::kPlanned, "zmp_" + axis + "_m", "ZMP, planned", kMmPerM)},
          .smallest_span = 10.0};
}

}  // namespace

void draw_gait(const simulation::Gait& gait, const sim_board::RobotDescription& robot,
               const simulation::NamedModel& model, const std::filesystem::path& prefix) {
  Figure figure{.title = fmt::format("Walking motion, {} points a cycle", gait.points)};
  figure.panels.push_back(pendulum_panel("x", "ahead"));
  figure.panels.push_back(pendulum_panel("y", "left"));
  for (const ShownJoint& joint : kShown) {
    figure.panels.push_back({.y_label = std::string(joint.label) + " [deg]",
                             .series = {series(Role::kFirst, std::string(joint.column) + "_rad",
                                               "profile of the pendulum", kDegreesPerRad),
                                        series(Role::kPlanned, std::string(joint.column) + "_points_rad",
                                               "target, between points", kDegreesPerRad)},
                             .smallest_span = 2.0});
  }
  draw_with_csv(figure, profile_of(gait, robot, model), prefix, kDigits);
}

}  // namespace koboshi::tools
