#include "simulation/assembly/plant.h"

#include <utility>

#include "base/text/error.h"
#include "sim_board/description/edit/robot_text.h"
#include "sim_board/description/load.h"
#include "simulation/scenario/reader.h"

namespace koboshi::simulation {

void apply_plant(XmlDocument& robot, std::span<const PlantSetting> plant) {
  XmlDocument edited = robot;
  for (const PlantSetting& setting : plant) {
    try {
      sim_board::edit_settings(edited, {{setting.field.text, setting.value}}, sim_board::Sides::kOne);
    } catch (const InputError& error) {
      throw InputError(setting.field.source, setting.field.line, error.found(), error.expected());
    }
  }
  robot = std::move(edited);
}

std::optional<sim_board::RobotDescription> read_plant(const Scenario& scenario) {
  if (scenario.plant.empty()) return std::nullopt;
  XmlDocument document(scenario.robot);
  apply_plant(document, scenario.plant);
  return sim_board::load_robot(document.source(), document.text());
}

sim_board::RobotDescription robot_in_world(const Scenario& scenario) {
  sim_board::RobotDescription model = read_robot(scenario);
  auto plant = read_plant(scenario);
  return plant ? std::move(*plant) : std::move(model);
}

}  // namespace koboshi::simulation
