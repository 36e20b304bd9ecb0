#pragma once

#include <array>
#include <random>
#include <stdexcept>

#include "firmware/estimation/posture.h"
#include "tests/unit/firmware/robot/reference.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::test {

// The test robot in random poses within the joints' ranges, with a reference model in double.
struct RandomPosture {
  static robot::RobotModel make_model() {
    robot::RobotModel loaded;
    robot::RobotModel written = make_test_robot();
    // Features that the default robot lacks: an oblique axis, a reversed one, a sensor beside the ankle.
    written.joints[13].axis = {
        fixed::from_double<fixed::Ratio>(0.6), {}, fixed::from_double<fixed::Ratio>(0.8)};
    written.joints[15].axis = -robot::kAxisY;
    written.feet[1].sensor = position(0.004, -0.003, 0.025);
    if (robot::load_model(encode(written), loaded) != robot::ModelStatus::kOk) {
      throw std::logic_error("the test robot is no robot");
    }
    return loaded;
  }

  // Draws a new pose.
  void draw() {
    for (std::size_t i = 0; i < model.joint_count; ++i) {
      const double lower_rad = fixed::to_double(model.joints[i].lower);
      const double upper_rad = fixed::to_double(model.joints[i].upper);
      angles[i] =
          fixed::from_double<fixed::Angle>(std::uniform_real_distribution(lower_rad, upper_rad)(random));
      angles_rad[i] = fixed::to_double(angles[i]);
    }
    posture = estimation::posture_at(model, angles);
  }

  Point com_B() const { return centre_of_mass(model, angles_rad); }
  Point from_sole(hal::Side side, const Point& p_Sole) const {
    return test::from_sole(model, angles_rad, side, p_Sole);
  }
  Point to_sole(hal::Side side, const Point& p_B) const {
    return test::to_sole(model, angles_rad, side, p_B);
  }

  robot::RobotModel model = make_model();
  std::mt19937 random{20081};
  std::array<fixed::Angle, robot::kMaxJoints> angles{};
  std::array<double, robot::kMaxJoints> angles_rad{};
  estimation::Posture posture;
};

}  // namespace koboshi::test
