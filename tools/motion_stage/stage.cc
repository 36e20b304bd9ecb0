#include "tools/motion_stage/stage.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <string>

#include "simulation/scenario/paths.h"
#include "simulation/scenario/reader.h"

namespace koboshi::tools {
namespace {

// When the robot of scenarios/motion.yaml is enabled.
constexpr double kEnable_s = 2.0;
// After the motion, for the robot to come to rest or to fall.
constexpr double kRest_s = 2.0;

}  // namespace

simulation::Scenario stage_scenario(const std::filesystem::path& motion, const MotionReport& checked,
                                    std::vector<Override> overrides) {
  const auto stage = simulation::find_input(simulation::InputKind::kScenario, "scenarios/motion.yaml");
  const simulation::Scenario empty = simulation::read_scenario(stage, overrides);
  const std::string name = motion.stem().string();
  nlohmann::json motions = empty.missing_motions;  // are named again, so that they are reported
  std::erase(motions.get_ref<nlohmann::json::array_t&>(), nlohmann::json(name));
  for (const simulation::MotionChoice& other : empty.motions) {
    if (other.name() != name) motions.push_back(other.file.string());
  }
  motions.push_back(std::filesystem::absolute(motion).string());
  const double begin_s = 1e-6 * static_cast<double>(empty.duration_us);
  const double end_s = begin_s + checked.duration_s;
  nlohmann::json commands = {{{"at_s", kEnable_s}, {"enable", true}}, {{"at_s", begin_s}, {"play", name}}};
  if (checked.endless) commands.push_back({{"at_s", end_s}, {"stop", true}});
  const double duration_s = (checked.endless ? end_s + checked.duration_s : end_s) + kRest_s;
  overrides.push_back({"motions", motions.dump(), "MOTION"});
  overrides.push_back({"commands", commands.dump(), "MOTION"});
  overrides.push_back({"duration_s", fmt::format("{:.2f}", duration_s), "MOTION"});
  return simulation::read_scenario(stage, overrides);
}

}  // namespace koboshi::tools
