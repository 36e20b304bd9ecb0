#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sim_board/robot/description.h"
#include "sim_board/scenario/scenario.h"
#include "simulation/gait/gait_plan.h"
#include "simulation/model/robot_model.h"

namespace koboshi::simulation {

// A scenario with its files read and compiled: all that a robot needs before it is switched on.
struct PreparedScenario {
  sim::Scenario scenario;       // with what its gait brings along
  sim::RobotDescription robot;  // as its file describes it
  NamedModel model{};
  std::optional<GaitPlan> gait_plan{};  // what the gait intends
  std::vector<std::byte> storage_contents{};
};

// Throws sim::InputError for whatever a file of the scenario has wrong.
PreparedScenario prepare(const sim::Scenario& scenario);

}  // namespace koboshi::simulation
