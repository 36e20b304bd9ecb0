#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sim_board/engine/make_world.h"
#include "sim_board/world/options.h"

namespace koboshi::sim_board {

inline constexpr double kGravity = 9.80665;
inline constexpr double kPi = std::numbers::pi;

inline void run(World& world, double duration_s) {
  const auto steps = std::lround(duration_s / world.step_s());
  for (long i = 0; i < steps; ++i) world.step();
}

// The engines, each by a stepper that is exact in its own terms.
inline std::vector<Stepper> engines() { return {Stepper::kWorld, Stepper::kMujoco}; }

// Tests of what holds in each of them, or of those that this program was built with.
class EachEngine : public testing::TestWithParam<Stepper> {
 protected:
  void SetUp() override {
    if (in_mujoco() && !has_mujoco()) GTEST_SKIP() << "built without MuJoCo";
  }
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

}  // namespace koboshi::sim_board
