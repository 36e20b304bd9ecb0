#include "tools/lab/validate/squat.h"

#include <cmath>

#include "sim_board/input/error.h"
#include "sim_board/scenario/reader.h"

namespace koboshi::tools {

sim::Scenario squat_scenario(const ValidationSetup& setup) {
  sim::Scenario scenario = sim::read_scenario(setup.scenario, {});
  if (scenario.motions.empty()) {
    throw sim::InputError(setup.scenario, 0, "no motion", "the scenario of squats");
  }
  scenario.initial.release_us = 1'400'000;
  scenario.commands = {{.at_us = 700'000, .kind = sim::Command::Kind::kEnable},
                       {.at_us = 1'500'000, .kind = sim::Command::Kind::kPlay, .motion = 0}};
  scenario.physics = {.step_us = static_cast<std::uint64_t>(std::llround(1e6 * setup.world.step_s)),
                      .stepper = setup.world.stepper,
                      .quick_iterations = setup.world.quick_iterations};
  return scenario;
}

}  // namespace koboshi::tools
