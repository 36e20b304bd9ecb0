#pragma once

#include "sim_board/scenario/scenario.h"
#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// The whole robot in squats, quicker than in the scenario's file: enabled at 0.7 s, standing by itself from
// 1.4 s, told to play at 1.5 s. It begins to go down at 3.5 s and is down at 4.5 s.
inline constexpr std::uint64_t kSquatBegins_us = 3'500'000;

// Throws sim::InputError where the setup's scenario does not play a motion.
[[nodiscard]] sim::Scenario squat_scenario(const ValidationSetup& setup);

}  // namespace koboshi::tools
