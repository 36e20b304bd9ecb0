#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "firmware/motion/roles.h"
#include "tests/support/controller_bench.h"
#include "tests/support/robot_storage.h"
#include "tests/support/sdo_pc.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::app {

// A robot on a fake board that has all motions for getting up, and is limp. Of its movement there is only
// what the test tells the inertial unit.
class RecoveryTest : public testing::Test {
 protected:
  using Opcode = motion::Opcode;
  using Role = motion::Role;
  static constexpr std::uint8_t kFirstMotion = 8;

  void SetUp() override {
    bench.board.storage.complete_after(1);
    ASSERT_TRUE(bench.run_until(State::kLimp));
    for (std::size_t role = 0; role < motion::kMotionNames.size(); ++role) give(static_cast<Role>(role), {});
    bench.run_ms(1'100);  // the estimate of the gyro bias needs one second
  }
  // Stores a motion of 0.2 s that ends with these steps.
  void give(Role role, const std::vector<motion::Step>& last_steps) {
    const auto index = static_cast<std::size_t>(role);
    std::vector<fixed::Angle> pose(bench.model().joint_count);
    pose[3] = test::degrees(10);
    test::TestMotion motion{.name = std::string(motion::kMotionNames[index]),
                            .poses = {pose},
                            .steps = {{Opcode::kMove, 0, 200'000}}};
    motion.steps.insert(motion.steps.end(), last_steps.begin(), last_steps.end());
    motion.steps.push_back({Opcode::kEnd});
    const canopen::ObjectAddress object{kMotionObject, static_cast<std::uint8_t>(kFirstMotion + index + 1)};
    ASSERT_EQ(pc.download_blocks(object, test::encode(motion, bench.model().id)), canopen::AbortCode::kNone);
  }
  std::uint8_t number_of(Role role) const { return kFirstMotion + static_cast<std::uint8_t>(role); }
  void stand() {
    bench.command(Command::kEnable);
    ASSERT_TRUE(bench.run_until(State::kStanding));
  }
  // Turns the trunk to this attitude within `time_ms`, with consistent gyro readings, and holds it.
  void turn_to(double roll_deg, double pitch_deg, int time_ms = 200) {
    const double per_s = 1e3 / time_ms;
    bench.imu_sample.gyro_raw[0] =
        counts((roll_deg - roll_deg_) * test::kRadPerDegree * per_s * test::kCountsPerRadPerS);
    bench.imu_sample.gyro_raw[1] =
        counts((pitch_deg - pitch_deg_) * test::kRadPerDegree * per_s * test::kCountsPerRadPerS);
    bench.run_ms(time_ms);
    bench.imu_sample.gyro_raw = {};
    roll_deg_ = roll_deg;
    pitch_deg_ = pitch_deg;
    const double roll = roll_deg * test::kRadPerDegree;
    const double pitch = pitch_deg * test::kRadPerDegree;
    bench.imu_sample.accelerometer_raw = {counts(-std::sin(pitch) * test::kCountsPerG),
                                          counts(std::sin(roll) * std::cos(pitch) * test::kCountsPerG),
                                          counts(std::cos(roll) * std::cos(pitch) * test::kCountsPerG)};
  }
  static std::int16_t counts(double value) { return static_cast<std::int16_t>(std::lround(value)); }
  void expect_state(State state, Reason reason) const {
    EXPECT_EQ(bench.now().state, state);
    EXPECT_EQ(bench.now().reason, reason);
  }
  void lie_limp_from_standing(double roll_deg, double pitch_deg) {
    stand();
    turn_to(roll_deg, pitch_deg);
    ASSERT_TRUE(bench.run_until(State::kFallen, 100));
  }

  test::ControllerBench bench;
  test::SdoPc pc{bench};

 private:
  double roll_deg_ = 0.0;
  double pitch_deg_ = 0.0;
};

}  // namespace koboshi::app
