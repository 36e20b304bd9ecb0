#include "lab/bring_up/robot_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "simulation/record/state_hash.h"
#include "simulation/scenario/reader.h"

namespace koboshi::lab {
namespace {

namespace fs = std::filesystem;

void write_all(const RobotFiles& files, const fs::path& folder) {
  for (const auto& [name, text] : files) {
    fs::create_directories((folder / name).parent_path());
    write_whole_file(folder / name, text);
  }
}

}  // namespace

std::vector<std::string> motion_names(const RobotFiles& files) {
  std::vector<std::string> names;
  for (const auto& [name, text] : files) {
    if (name.parent_path() == "motions") names.push_back(name.stem().string());
  }
  std::ranges::stable_partition(names, [](const std::string& name) { return name == "stand"; });
  return names;
}

std::shared_ptr<const simulation::PreparedScenario> prepare_files(const RobotFiles& files,
                                                                  const fs::path& robot,
                                                                  const TemporaryFolder& scratch,
                                                                  std::span<const Override> overrides) {
  write_all(files, scratch.path());
  const fs::path own = fs::absolute(robot);
  std::vector<Override> all{text_override("robot", own.string(), "robot"), {"motions", "[]"}};
  all.insert(all.end(), overrides.begin(), overrides.end());
  simulation::Scenario scenario = simulation::read_scenario(scratch.path() / "go.yaml", all);
  for (const std::string& name : motion_names(files))
    scenario.motions.push_back({.file = scratch.path() / "motions" / (name + ".yaml"), .overrides = {}});
  // Those of the robot's own folder are of an earlier rung.
  scenario.robot_parameters = simulation::read_robot_parameters(scratch.path() / own.filename());
  return std::make_shared<const simulation::PreparedScenario>(simulation::prepare(scenario));
}

bool is_foreign(const fs::path& file) {
  std::error_code missing;
  if (!fs::exists(file, missing)) return false;
  const std::string text = read_text_file(file, "a file");
  return text.find(kOrigin) == std::string::npos;
}

std::optional<std::string> read_own(const fs::path& file) {
  std::error_code missing;
  if (!fs::exists(file, missing)) return std::nullopt;
  if (is_foreign(file))
    throw InputError(file, 0, "a file that bring-up has not written",
                     "none, or one of an earlier bring-up: move it away");
  return read_text_file(file, "a file");
}

std::string hash_of(const std::string& text) {
  simulation::StateHash hash;
  hash.add(std::as_bytes(std::span(text)));
  return hash.hex();
}

}  // namespace koboshi::lab
