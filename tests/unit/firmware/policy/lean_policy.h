#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include "firmware/robot/model.h"
#include "simulation/policy/policy_image.h"

namespace koboshi::test {

// A policy for tests: the ankles follow the trunk's rates by two layers, within 4 degrees. Roll and pitch are
// inputs without weight; `roll_range` of 2^-24 turn is that of the first, +-36 degrees by default.
inline std::vector<std::byte> lean_policy(const robot::RobotModel& model,
                                          std::int32_t roll_range = 1'677'722) {
  using policy::Signal;
  constexpr std::int32_t kRateRange = 800'000;           // 4.8 rad/s
  constexpr std::int32_t kRateMultiplier = 210'828'000;  // 4,096 for 0.5 rad/s
  const auto signal = [](Signal first, int place) {
    return static_cast<std::uint8_t>(static_cast<int>(first) + place);
  };
  simulation::PolicyContents contents{.model_id = model.id, .name = "lean", .patience_ticks = 5};
  contents.inputs = {
      {signal(Signal::kRoll, 0), 0, 1 << 24, -roll_range, roll_range},
      {signal(Signal::kPitch, 0), 0, 1 << 24, -1'677'722, 1'677'722},
      {signal(Signal::kRollRate, 0), 0, kRateMultiplier, -kRateRange, kRateRange},
      {signal(Signal::kRollRate, 1), 0, kRateMultiplier, -kRateRange, kRateRange},
  };
  using enum robot::JointRole;
  for (const robot::JointRole role : {kLeftAnkleRoll, kRightAnkleRoll, kLeftAnklePitch, kRightAnklePitch}) {
    contents.outputs.push_back({.joint = static_cast<std::uint8_t>(*model.find(role)),
                                .scale = 800,
                                .bound = fixed::Angle::from_raw(47'721'858),   // 4 degrees
                                .rate = fixed::Angle::from_raw(11'930'464)});  // 1 degree
  }
  simulation::PolicyLayer hidden{.rows = 8,
                                 .columns = 4,
                                 .activation = policy::Activation::kTanh,
                                 .multiplier = 1 << 25,
                                 .biases = std::vector<std::int32_t>(8),
                                 .weights = std::vector<std::int8_t>(32)};
  hidden.weights[2] = 64;      // row 0: the rate of roll
  hidden.weights[4 + 3] = 64;  // row 1: the rate of pitch
  simulation::PolicyLayer last{.rows = 4,
                               .columns = 8,
                               .multiplier = 1 << 25,
                               .biases = std::vector<std::int32_t>(4),
                               .weights = std::vector<std::int8_t>(32)};
  last.weights[0] = last.weights[8] = 64;
  last.weights[16 + 1] = last.weights[24 + 1] = 64;
  contents.layers = {hidden, last};
  return simulation::make_policy_image(contents);
}

inline std::filesystem::path write_policy(const std::filesystem::path& file,
                                          const std::vector<std::byte>& image) {
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(image.data()), static_cast<std::streamsize>(image.size()));
  return file;
}

}  // namespace koboshi::test
