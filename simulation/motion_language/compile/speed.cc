#include "simulation/motion_language/compile/speed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/motion_language/parse/codes.h"

namespace koboshi::simulation {
namespace {

// Peak speed over mean speed: linear, minimum jerk (Flash and Hogan 1985), a cubic from rest to rest, and a
// trapezoid.
constexpr std::array<double, 4> kPeakRatios{1.0, 15.0 / 8.0, 3.0 / 2.0, 3.0 / 2.0};
constexpr double kSpeedUnit_rad_per_s = 2.0 * std::numbers::pi / (1 << 24);

// Bounds the work for nested loops, each of which is walked twice.
constexpr std::size_t kMaxWalked = 100'000;

// Tells the peak speed of each joint in each move.
using SpeedVisitor = std::function<void(const StepSource& move, std::size_t joint, double rad_per_s)>;

class SpeedWalk {
 public:
  SpeedWalk(const MotionSource& motion, std::size_t joints, SpeedVisitor visit)
      : motion_(motion), visit_(std::move(visit)), angles_(joints) {}

  void all() {
    routine(motion_.steps);
    for (const RoutineSource& own : motion_.routines) routine(own.steps);
  }

 private:
  void routine(const std::vector<StepSource>& steps) {
    forget();
    walk(steps);
  }

  using Kind = StepSource::Kind;
  using Angles = std::vector<std::optional<fixed::Angle>>;

  void forget() { angles_.assign(angles_.size(), std::nullopt); }

  void walk(const std::vector<StepSource>& steps) {
    for (const StepSource& step : steps) {
      if (++walked_ > kMaxWalked) return;
      switch (step.kind) {
        case Kind::kMove:
          move(step);
          break;
        case Kind::kLabel:
        case Kind::kCall:
          forget();
          break;
        case Kind::kLoop:
          loop(step);
          break;
        case Kind::kIf:
          branch(step);
          break;
        default:
          break;
      }
    }
  }

  void loop(const StepSource& step) {
    const Angles before = angles_;
    walk(step.body);
    // The second pass starts from the pose at the end of the body.
    const bool repeats = step.loop != StepSource::LoopKind::kTimes || step.times != 1;
    if (repeats) walk(step.body);
    if (step.loop == StepSource::LoopKind::kWhile) merge(before);
  }

  void branch(const StepSource& step) {
    const Angles before = angles_;
    walk(step.body);
    const Angles after = angles_;
    angles_ = before;
    walk(step.otherwise);
    merge(after);
  }

  void merge(const Angles& other) {
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      if (angles_[i] != other[i]) angles_[i].reset();
    }
  }

  void move(const StepSource& step) {
    const PoseSource& pose = motion_.poses[step.pose];
    const double time_s = time_of(step, pose);
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      if (!pose.angles[i]) continue;
      if (angles_[i] && !step.at_least) tell(step, i, distance_rad(i, pose), time_s * share_of(step, i));
      angles_[i] = pose.angles[i];
    }
  }

  // The share of the move's time in which a joint turns.
  static double share_of(const StepSource& step, std::size_t joint) {
    const motion::Window window = window_of(step, joint);
    return static_cast<double>(window.end - window.start) / motion::Window::kWhole;
  }

  double distance_rad(std::size_t joint, const PoseSource& pose) const {
    return std::abs(fixed::to_double(*pose.angles[joint]) - fixed::to_double(*angles_[joint]));
  }

  static double peak_ratio(const StepSource& step) {
    return kPeakRatios.at(static_cast<std::size_t>(step.interpolation));
  }

  // The duration of a move; 0 if it follows from an unknown angle.
  double time_of(const StepSource& step, const PoseSource& pose) const {
    if (step.speed_raw == 0) return step.time_us * 1e-6;
    double farthest_rad = 0.0;
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      if (!pose.angles[i]) continue;
      if (!angles_[i]) return 0.0;
      farthest_rad = std::max(farthest_rad, distance_rad(i, pose));
    }
    return std::max(peak_ratio(step) * farthest_rad / (step.speed_raw * kSpeedUnit_rad_per_s),
                    motion::kMinStepTime_us * 1e-6);
  }

  void tell(const StepSource& step, std::size_t joint, double way_rad, double time_s) const {
    if (time_s > 0.0) visit_(step, joint, peak_ratio(step) * way_rad / time_s);
  }

  const MotionSource& motion_;
  SpeedVisitor visit_;
  Angles angles_;
  std::size_t walked_ = 0;
};

double limit_rad_per_s(const NamedModel& robot, std::size_t joint) {
  return fixed::to_double(robot.model.joints[joint].max_speed);
}

}  // namespace

void check_speeds(const MotionSource& motion, const NamedModel& robot, Diagnostics& diagnostics) {
  const auto text = [](double rad_per_s) { return number_text(std::round(rad_per_s * kDegreesPerRad)); };
  SpeedWalk(motion, robot.joint_names.size(),
            [&](const StepSource& move, std::size_t joint, double rad_per_s) {
              const double limit = limit_rad_per_s(robot, joint);
              if (rad_per_s <= limit * (1.0 + 1e-9)) return;
              diagnostics.add(
                  {.code = code::kTooFast,
                   .place = move.place,
                   .found = "a move of " + robot.joint_names[joint] + " at " + text(rad_per_s) + " degrees/s",
                   .expected = "at most " + text(limit),
                   .limit = "the speed of " + robot.joint_names[joint]});
            })
      .all();
}

std::map<const StepSource*, FastestJoint> fastest_joints(const MotionSource& motion,
                                                         const NamedModel& robot) {
  std::map<const StepSource*, FastestJoint> moves;
  SpeedWalk(motion, robot.joint_names.size(),
            [&](const StepSource& move, std::size_t joint, double rad_per_s) {
              const double share = rad_per_s / limit_rad_per_s(robot, joint);
              FastestJoint& fastest = moves[&move];
              if (share > fastest.share) fastest = {joint, rad_per_s, share};
            })
      .all();
  return moves;
}

}  // namespace koboshi::simulation
