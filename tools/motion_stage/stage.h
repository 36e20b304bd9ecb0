#pragma once

#include <filesystem>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "simulation/scenario/scenario.h"
#include "tools/motion_check/check.h"

namespace koboshi::tools {

// The scenario in which a motion is played: scenarios/motion.yaml of this checkout with the motion in place
// of one of the same name. The motion begins once the robot stands; a motion without an end is stopped after
// twice its duration. `checked` is the motion's report. Throws InputError.
[[nodiscard]] simulation::Scenario stage_scenario(const std::filesystem::path& motion,
                                                  const MotionReport& checked,
                                                  std::vector<Override> overrides = {});

}  // namespace koboshi::tools
