#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sim_board/engine/make_world.h"
#include "sim_board/world/options.h"

namespace koboshi::sim {

inline constexpr double kGravity = 9.80665;
inline constexpr double kPi = std::numbers::pi;

inline void run(World& world, double duration_s) {
  const auto steps = std::lround(duration_s / world.step_s());
  for (long i = 0; i < steps; ++i) world.step();
}

// The engines that this program was built with, each by a stepper that is exact in its own terms.
inline std::vector<Stepper> engines() {
  return has_mujoco() ? std::vector{Stepper::kWorld, Stepper::kMujoco} : std::vector{Stepper::kWorld};
}

// Tests of what holds in each of them.
class EachEngine : public testing::TestWithParam<Stepper> {
 protected:
  static bool in_mujoco() { return GetParam() == Stepper::kMujoco; }
  static WorldOptions options() {
    WorldOptions options;
    options.stepper = GetParam();
    return options;
  }
};

inline std::string engine_name(const testing::TestParamInfo<Stepper>& info) {
  return std::string(name_of(info.param));
}

}  // namespace koboshi::sim
