#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sim_board/robot/description.h"
#include "sim_board/scenario/scenario.h"
#include "simulation/gait/gait_plan.h"
#include "simulation/model/robot_model.h"

namespace koboshi::simulation {

// A scenario with all its files read and compiled, ready for power-on.
struct PreparedScenario {
  sim::Scenario scenario;       // including the items that its gait adds
  sim::RobotDescription robot;  // as described in its file
  NamedModel model{};
  std::optional<GaitPlan> gait_plan{};  // the reference of the gait
  std::vector<std::byte> storage_contents{};
};

// Reads and compiles a scenario. Throws sim::InputError for an error in any of its files.
PreparedScenario prepare(const sim::Scenario& scenario);

}  // namespace koboshi::simulation
