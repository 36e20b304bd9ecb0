#include "simulation/motion/speed.h"

#include <cmath>

#include "firmware/fixed/host/convert.h"
#include "sim_board/input/error.h"
#include "sim_board/input/text.h"
#include "sim_board/input/user_units.h"

namespace koboshi::simulation {
namespace {

using Kind = StepSource::Kind;

class SpeedCheck {
 public:
  SpeedCheck(const MotionSource& motion, const NamedModel& robot)
      : motion_(motion), robot_(robot), angles_(robot.joint_names.size()) {}

  void walk(const std::vector<StepSource>& steps) {
    for (const StepSource& step : steps) {
      if (step.kind == Kind::kMove) move(step);
      if (step.kind == Kind::kLabel) angles_.assign(angles_.size(), std::nullopt);
      if (step.kind != Kind::kLoop) continue;
      walk(step.body);
      if (step.times != 1) walk(step.body);  // the second pass starts from the pose at the end of the body
    }
  }

 private:
  void move(const StepSource& step) {
    const PoseSource& pose = motion_.poses[step.pose];
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      if (!pose.angles[i]) continue;
      if (angles_[i]) check_joint(step, i, fixed::to_double(*pose.angles[i]) - fixed::to_double(*angles_[i]));
      angles_[i] = pose.angles[i];
    }
  }

  void check_joint(const StepSource& step, std::size_t joint, double way_rad) const {
    const double speed_rad_per_s = std::abs(way_rad) / (step.time_us * 1e-6);
    const double limit_rad_per_s = fixed::to_double(robot_.model.joints[joint].max_speed);
    if (speed_rad_per_s <= limit_rad_per_s) return;
    const auto text = [](double rad_per_s) {
      return sim::number_text(std::round(rad_per_s * sim::kDegreesPerRad));
    };
    throw sim::InputError(
        motion_.file, step.line,
        "a move of " + robot_.joint_names[joint] + " at " + text(speed_rad_per_s) + " degrees/s",
        "at most " + text(limit_rad_per_s), "the speed of " + robot_.joint_names[joint]);
  }

  const MotionSource& motion_;
  const NamedModel& robot_;
  std::vector<std::optional<fixed::Angle>> angles_;
};

}  // namespace

void check_speeds(const MotionSource& motion, const NamedModel& robot) {
  SpeedCheck(motion, robot).walk(motion.steps);
}

}  // namespace koboshi::simulation
