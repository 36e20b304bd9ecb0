#pragma once

#include <array>
#include <cmath>
#include <span>
#include <stdexcept>

#include "tests/unit/firmware/robot/reference.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::test {

inline robot::RobotModel load_test_robot() {
  robot::RobotModel loaded;
  if (robot::load_model(encode(make_test_robot()), loaded) != robot::ModelStatus::kOk) {
    throw std::logic_error("the test robot is no robot");
  }
  return loaded;
}

// The robot at given joint angles, in double, expressed in a sole's frame.
class Posed {
 public:
  Posed(const robot::RobotModel& model, std::span<const fixed::Angle> angles) : model_(model) {
    for (std::size_t i = 0; i < model.hinge_count(); ++i)
      angles_rad_[i] = fixed::to_double(model.hinge_angle(angles, robot::JointIndex(i)));
  }

  Point sole(hal::Side side, hal::Side seen_from) const {
    return seen(from_sole(model_, angles_rad_, side, {}), seen_from);
  }
  // An axis of a sole or of the trunk, expressed in the axes of another sole.
  Point sole_axis(hal::Side side, const Point& unit, hal::Side seen_from) const {
    return seen(from_sole(model_, angles_rad_, side, unit), seen_from) - sole(side, seen_from);
  }
  Point trunk_axis(const Point& unit, hal::Side seen_from) const {
    return seen(unit, seen_from) - seen({}, seen_from);
  }
  Point joint(std::size_t index, hal::Side seen_from) const {
    return seen(to_base(model_, angles_rad_, static_cast<int>(index), {}), seen_from);
  }
  Point com(hal::Side seen_from) const { return seen(centre_of_mass(model_, angles_rad_), seen_from); }

 private:
  Point seen(const Point& p_B, hal::Side from) const { return to_sole(model_, angles_rad_, from, p_B); }

  const robot::RobotModel& model_;
  std::array<double, robot::kMaxJoints> angles_rad_{};
};

// Yaw of an axis that points forward at `yaw` 0.
inline double yaw_rad(const Point& ahead) { return std::atan2(ahead.y, ahead.x); }

}  // namespace koboshi::test
