#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "firmware/walk/walker.h"
#include "tests/unit/firmware/walk/posed.h"

namespace koboshi::test {

// A gait with round numbers on rigid joints: the soles are where the targets place them. Independent of the
// tuned gait.
inline walk::WalkParameters rigid() {
  return {.step = {.time_ms = 260,
                   .double_support = 150,
                   .width = 660,
                   .height = 200,
                   .swing_profile = 300,
                   .acceleration = {300, 200, 1500},
                   .max_forward = 1300,
                   .max_lateral = 1300,
                   .min_lateral = 580},
          .posture = {.com_height = 1700,
                      .zmp_forward = 80,
                      .zmp_inward = 20,
                      .trunk_pitch = 546,
                      .trunk_pitch_by_speed = 0,
                      .pitch_compliance = 0,
                      .roll_compliance = 0,
                      .arm_swing = 0,
                      .fixed_upper_body = 1},
          .reaction = {.capture_forward = 0,
                       .capture_lateral = 0,
                       .dead_band = 50,
                       .smoothing = 500,
                       .heading_hold = 0}};  // the simulated gyro measures no rotation
}

// A walker on the test robot, whose joints follow their targets exactly and whose trunk leans as planned.
class WalkingRobot {
 public:
  // A touchdown: position relative to the other foot.
  struct Landing {
    int tick;
    hal::Side side;
    Point p;
    double yaw_rad;
  };

  explicit WalkingRobot(const walk::WalkParameters& gait = rigid())
      : parameters(gait), standing(model.joint_count), walker(model) {
    for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
      const auto leg = model.leg(side);
      standing[leg[2]] = degrees(-16);
      standing[leg[3]] = degrees(44);
      standing[leg[4]] = degrees(-28);
    }
    standing[13] = degrees(8);  // keeps the arms off the trunk
    standing[16] = degrees(-8);
    walker.start(parameters, standing);
  }

  // Advances one cycle. The sensors report the planned movement plus `more`.
  void advance(const walk::Velocity& command = {}, walk::Observation more = {}) {
    more.pitch += walker.pitch();
    walker.advance(command, more);
    ++tick;
    note_landing();
  }
  bool advance_until_landing(const walk::Velocity& command = {}, const walk::Observation& more = {}) {
    const std::size_t before = landings.size();
    for (int i = 0; i < 200 && landings.size() == before && walker.running(); ++i) advance(command, more);
    return landings.size() > before;
  }
  // Returns false if the walk does not end within ten seconds.
  bool advance_to_the_end(const walk::Velocity& command = {}) {
    for (int i = 0; i < 1'000 && walker.running(); ++i) advance(command);
    return !walker.running();
  }

  Posed posed() const { return {model, walker.targets()}; }
  // The swing foot, if there is one.
  // While the standing pose fades, the soles are not where the plan has them.
  std::optional<hal::Side> swing_side() const {
    if (tick <= kBlendTicks) return {};
    const double height_m = posed().sole(hal::Side::kRight, hal::Side::kLeft).z;
    if (std::abs(height_m) < kOnTheGround_m) return {};
    return height_m > 0 ? hal::Side::kRight : hal::Side::kLeft;
  }
  std::vector<fixed::Angle> targets() const { return {walker.targets().begin(), walker.targets().end()}; }

  robot::RobotModel model = load_test_robot();
  walk::WalkParameters parameters;  // of the walk, which takes changes
  std::vector<fixed::Angle> standing;
  walk::Walker walker;
  std::vector<Landing> landings;
  int tick = 0;

 private:
  static constexpr double kOnTheGround_m = 0.02e-3;
  static constexpr int kBlendTicks = 25;

  void note_landing() {
    const auto now = swing_side();
    if (swung_ && now != swung_) {
      const hal::Side other = walk::other(*swung_);
      const Posed pose = posed();
      landings.push_back(
          {tick, *swung_, pose.sole(*swung_, other), yaw_rad(pose.sole_axis(*swung_, {1, 0, 0}, other))});
    }
    swung_ = now;
  }

  std::optional<hal::Side> swung_;
};

}  // namespace koboshi::test
