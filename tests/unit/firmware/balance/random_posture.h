#pragma once

#include <array>
#include <random>
#include <stdexcept>

#include "firmware/balance/posture.h"
#include "tests/unit/firmware/robot/reference.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::test {

// The test robot in poses drawn over the ranges of its joints, with the reference in double beside it.
struct RandomPosture {
  static robot::RobotModel make_model() {
    robot::RobotModel loaded;
    robot::RobotModel written = make_test_robot();
    // What the default robot does not have: an oblique axis, a reversed one, a sensor beside the ankle.
    written.joints[13].axis = {
        fixed::from_double<fixed::Ratio>(0.6), {}, fixed::from_double<fixed::Ratio>(0.8)};
    written.joints[15].axis = -robot::kAxisY;
    written.feet[1].sensor = position(0.004, -0.003, 0.025);
    if (robot::load_model(encode(written), loaded) != robot::ModelStatus::kOk) {
      throw std::logic_error("the test robot is no robot");
    }
    return loaded;
  }

  // A new pose; the posture has seen all of it.
  void draw() {
    for (std::size_t i = 0; i < model.joint_count; ++i) {
      const double lower_rad = fixed::to_double(model.joints[i].lower);
      const double upper_rad = fixed::to_double(model.joints[i].upper);
      angles[i] =
          fixed::from_double<fixed::Angle>(std::uniform_real_distribution(lower_rad, upper_rad)(random));
      angles_rad[i] = fixed::to_double(angles[i]);
    }
    for (int cycle = 0; cycle < 6; ++cycle) update();
  }

  void update() {
    posture.update([this](std::size_t joint) { return angles[joint]; });
  }

  Point com_B() const {
    double mass_kg = fixed::to_double(model.base_mass);
    Point moment = mass_kg * to_point(model.base_centre_of_mass);
    for (std::size_t i = 0; i < model.joint_count; ++i) {
      const double link_kg = fixed::to_double(model.joints[i].mass);
      moment = moment + link_kg * to_base(model, angles_rad, static_cast<int>(i),
                                          to_point(model.joints[i].centre_of_mass));
      mass_kg += link_kg;
    }
    return (1.0 / mass_kg) * moment;
  }
  // A point of a sole's frame as B sees it, and back.
  Point from_sole(hal::Side side, Point p_Sole) const {
    p_Sole.z -= fixed::to_double(model.feet[static_cast<std::size_t>(side)].ankle_height);
    return to_base(model, angles_rad, ankle(side), p_Sole);
  }
  Point to_sole(hal::Side side, const Point& p_B) const {
    const Point r = p_B - from_sole(side, {});
    const auto axis = [&](const Point& unit) {
      return dot(r, to_base(model, angles_rad, ankle(side), unit, true));
    };
    return {axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1})};
  }
  int ankle(hal::Side side) const { return model.leg(side)[robot::kLegJoints - 1]; }

  robot::RobotModel model = make_model();
  std::mt19937 random{20081};
  std::array<fixed::Angle, robot::kMaxJoints> angles{};
  std::array<double, robot::kMaxJoints> angles_rad{};
  balance::Posture posture{model};
};

}  // namespace koboshi::test
