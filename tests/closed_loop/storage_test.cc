// A PC writes motions and parameters to the robot's storage over the bus.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "bus/can/sdo_transfer.h"
#include "firmware/app/dictionary.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/scenario/reader.h"
#include "tests/closed_loop/pc.h"

namespace koboshi {
namespace {

using test::kController;

constexpr canopen::ObjectAddress kSecondMotion{0x2400, 2};
constexpr canopen::ObjectAddress kCommand{0x2000, 1};
constexpr canopen::ObjectAddress kArgument{0x2000, 2};
constexpr canopen::ObjectAddress kState{0x2001, 1};
constexpr std::uint64_t kStanding_us = 4'000'000;

// The robot of scenarios/squat.yaml with the standing motion alone.
simulation::Scenario stand() {
  const std::vector<Override> overrides{{"physics.stepper", "lumped"},
                                        {"motions", "[robots/koboshi/motions/stand.yaml]"},
                                        {"commands", "[{at_s: 2, enable: true}]"}};
  return simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml", overrides);
}

std::vector<std::uint8_t> image_of(const std::string& motion, const simulation::Simulation& simulation) {
  const auto image = simulation::compile_motion(
      KOBOSHI_SOURCE_DIR "/robots/koboshi/motions/" + motion + ".yaml", simulation.model());
  std::vector<std::uint8_t> bytes(image.size());
  std::ranges::transform(image, bytes.begin(),
                         [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
  return bytes;
}

canopen::AbortCode refusal(const std::function<void()>& transfer) {
  try {
    transfer();
  } catch (const bus::SdoAborted& aborted) {
    return aborted.code();
  }
  return canopen::AbortCode::kNone;
}

TEST(Storage, PlaysAMotionDownloadedOverTheBus) {
  simulation::Simulation simulation(stand());
  test::Pc pc(simulation, kController);
  bus::SdoTransfer sdo(pc, kController);
  const std::vector<std::uint8_t> image = image_of("squat", simulation);
  pc.advance_until_us(kStanding_us);

  std::vector<std::uint8_t> broken = image;
  broken[broken.size() / 2] ^= 1;
  EXPECT_EQ(refusal([&] { sdo.download(kSecondMotion, broken); }), canopen::AbortCode::kInvalidValue);
  sdo.download(kSecondMotion, image);
  EXPECT_EQ(sdo.upload(kSecondMotion), image);

  sdo.write(kArgument, std::array<std::uint8_t, 2>{1, 0});
  sdo.write(kCommand, std::array<std::uint8_t, 1>{static_cast<std::uint8_t>(behaviour::Command::kPlay)});
  const double standing_m = simulation.board().world().body(0).X_WL.translation().z();
  const auto lowest_within_m = [&](std::uint64_t time_us) {
    double lowest_m = standing_m;
    const std::uint64_t end_us = simulation.board().now_us() + time_us;
    while (simulation.board().now_us() < end_us) {
      pc.advance();
      lowest_m = std::min(lowest_m, simulation.board().world().body(0).X_WL.translation().z());
    }
    return lowest_m;
  };
  EXPECT_NEAR(standing_m - lowest_within_m(4'000'000), 0.030, 0.004);  // depth in the motion's file
  EXPECT_EQ(sdo.read(kState).at(0), static_cast<std::uint8_t>(behaviour::State::kMotion));
  // The motion that is played may be replaced: it is played to its end.
  const std::vector<std::uint8_t> other = image_of("stand", simulation);
  sdo.download(kSecondMotion, other);
  EXPECT_EQ(sdo.upload(kSecondMotion), other);
  EXPECT_NEAR(standing_m - lowest_within_m(2'000'000), 0.030, 0.004);
  EXPECT_EQ(sdo.read(kState).at(0), static_cast<std::uint8_t>(behaviour::State::kMotion));
}

// The horns of both ankle servos are mounted two degrees off, so the robot leans until the trims are set.
TEST(Storage, TrimsCompensateServoOffsets) {
  constexpr double kOff_rad = 0.035;
  constexpr auto kTrim = static_cast<std::uint16_t>(kOff_rad / (2.0 * std::numbers::pi) * 65536.0 + 0.5);
  const std::string ankles[] = {"left_ankle_pitch", "right_ankle_pitch"};
  const auto pitch_rad = [&](bool trimmed) {
    simulation::Simulation simulation(
        stand(), simulation::in_process(), [&](sim_board::RobotDescription& robot) {
          for (const std::string& name : ankles) {
            sim_board::JointDescription& joint =
                robot.joints[static_cast<std::size_t>(*robot.find_joint(name))];
            joint.encoder.offset_rad += joint.drive.sign * kOff_rad;  // offset of the shaft
          }
        });
    test::Pc pc(simulation, kController);
    bus::SdoTransfer sdo(pc, kController);
    pc.advance_until_us(1'500'000);  // limp
    for (const std::string& name : ankles) {
      if (!trimmed) continue;
      const auto joint = static_cast<std::uint8_t>(*simulation.robot().find_joint(name));
      sdo.write({0x2120, static_cast<std::uint8_t>(joint + 1)},
                std::array<std::uint8_t, 2>{kTrim & 0xFF, kTrim >> 8});
    }
    pc.advance_until_us(6'000'000);
    const Eigen::Matrix3d R_WB = simulation.board().world().body(0).X_WL.linear();
    return std::asin(-R_WB(2, 0));
  };
  EXPECT_GT(std::abs(pitch_rad(false)), 0.8 * kOff_rad);
  EXPECT_LT(std::abs(pitch_rad(true)), 0.1 * kOff_rad);
}

}  // namespace
}  // namespace koboshi
