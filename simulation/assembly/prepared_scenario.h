#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sim_board/description/description.h"
#include "simulation/gait/gait_plan.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// A scenario with all its files read and compiled, ready for power-on.
struct PreparedScenario {
  Scenario scenario;                                   // including the items that its gait adds
  sim_board::RobotDescription robot;                   // as described in its file: the firmware's model
  std::optional<sim_board::RobotDescription> plant{};  // the robot in the world where it differs from that
  NamedModel model{};
  std::optional<GaitPlan> gait_plan{};  // the reference of the gait
  std::vector<std::byte> storage_contents{};
  // Parts of the storage contents: the images of the motions, in their order, and of the robot's parameters.
  std::vector<std::vector<std::byte>> motions{};
  std::vector<std::byte> parameters{};

  const sim_board::RobotDescription& robot_in_world() const { return plant ? *plant : robot; }
};

// Reads and compiles a scenario. Throws InputError for an error in any of its files.
PreparedScenario prepare(const Scenario& scenario);

// Returns the scenario with this image of a policy in the factory's catalogue instead of its own, without
// reading its files again. Throws InputError, with the firmware's reason, if the robot cannot run it.
PreparedScenario with_policy(PreparedScenario prepared, std::span<const std::byte> image);

}  // namespace koboshi::simulation
