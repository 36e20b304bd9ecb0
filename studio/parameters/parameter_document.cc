#include "studio/parameters/parameter_document.h"

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/yaml/yaml_reader.h"
#include "simulation/assembly/robot_parameters.h"
#include "simulation/gait/gait.h"
#include "simulation/gait/gait_motion.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/scenario/reader.h"
#include "studio/document/edit_support.h"

namespace koboshi::studio {

namespace fs = std::filesystem;

ParameterDocument::Opened ParameterDocument::open(const fs::path& file) {
  ReadFile read = read_file_with_state(file);
  YamlDocument yaml(file, read.text);
  static_cast<void>(yaml.places());  // refuses what cannot be edited
  return {std::move(read), std::move(yaml)};
}

ParameterDocument::ParameterDocument(const fs::path& file)
    : ParameterDocument(fs::absolute(file), open(file)) {}

ParameterDocument::ParameterDocument(fs::path path, Opened opened)
    : TextDocument(std::move(path), opened.read.state),
      yaml_(opened.yaml),
      saved_(std::move(opened.yaml)),
      is_gait_(yaml_.tree().find("period_s") != nullptr),
      table_(is_gait_ ? gait_table() : controller_table()) {
  if (!is_gait_ && yaml_.tree().find("parameters") == nullptr)
    throw InputError(file(), 0, "neither parameters nor period_s", "parameters of a robot, or a gait");
}

std::optional<double> ParameterDocument::value_in(const YamlDocument& yaml, std::size_t index) const {
  const ParameterInfo& info = table_[index];
  const YamlNode* node = find_node(yaml.tree(), info.path);
  return node != nullptr ? parse_number(node->scalar) : info.fallback;
}

bool ParameterDocument::is_given(std::size_t index) const {
  return find_node(yaml_.tree(), table_[index].path) != nullptr;
}

std::optional<double> ParameterDocument::value(std::size_t index) const { return value_in(yaml_, index); }

std::optional<double> ParameterDocument::file_value(std::size_t index) const {
  return value_in(saved_, index);
}

bool ParameterDocument::is_changed(std::size_t index) const { return value(index) != file_value(index); }

std::vector<std::size_t> ParameterDocument::changed() const {
  std::vector<std::size_t> indices;
  for (std::size_t index = 0; index < table_.size(); ++index)
    if (is_changed(index)) indices.push_back(index);
  return indices;
}

// --- Edits

void ParameterDocument::check(const std::string& text) const {
  static_cast<void>(YamlDocument(file(), text).places());  // refuses what cannot be edited
}

std::string ParameterDocument::checked_text(std::size_t index, double value) const {
  const ParameterInfo& info = table_[index];
  const std::int64_t steps = info.steps(value);
  if (!(steps >= info.steps(info.low) && steps <= info.steps(info.high)))
    throw InputError(file(), 0, fmt::format("{} = {:.6g}", info.key, value),
                     fmt::format("{:.6g} to {:.6g} {}", info.low, info.high, info.unit));
  return info.text(value);
}

void ParameterDocument::set_in(YamlDocument& yaml, const ParameterValue& value) const {
  const ParameterInfo& info = table_[value.index];
  const std::string text = checked_text(value.index, value.value);
  std::vector<std::string> steps = info.path.steps();
  const std::string key = steps.back();
  steps.pop_back();
  const YamlPath map(steps);
  if (find_node(yaml.tree(), map) == nullptr) return yaml.set(map, "{" + key + ": " + text + "}");
  yaml.set(info.path, text);
}

void ParameterDocument::set(std::size_t index, double value, std::string_view drag) {
  const auto present = this->value(index);
  const ParameterInfo& info = table_[index];
  YamlDocument edited = yaml_;
  if (!present || info.steps(*present) != info.steps(value)) set_in(edited, {index, value});
  replace(edited.text(), "Change " + info.key, drag);
}

void ParameterDocument::set_all(std::span<const ParameterValue> values, std::string_view label) {
  YamlDocument edited = yaml_;
  for (const ParameterValue& value : values) set_in(edited, value);
  replace(edited.text(), label);
}

void ParameterDocument::reset_to_file(std::size_t index) {
  const YamlNode* before = find_node(saved_.tree(), table_[index].path);
  if (before == nullptr) return reset_to_default(index);
  YamlDocument edited = yaml_;
  edited.set(table_[index].path, before->scalar);
  replace(edited.text(), "Reset " + table_[index].key);
}

void ParameterDocument::reset_to_default(std::size_t index) {
  const ParameterInfo& info = table_[index];
  if (is_gait_ && !info.fallback)
    throw InputError(file(), 0, "no value of " + info.key, "one: it has no default");
  if (!is_given(index)) return;
  YamlDocument edited = yaml_;
  edited.erase(info.path);
  replace(edited.text(), "Default of " + info.key);
}

void ParameterDocument::reset_all_to_file() { replace(saved_.text(), "Reset all"); }

void ParameterDocument::replace_text(const std::string& text) {
  check(text);
  replace(text, "Restore");
}

// --- Use

simulation::RobotParameters ParameterDocument::robot_parameters() const {
  return simulation::read_robot_parameters(YamlFile(file(), yaml_.tree()));
}

std::string ParameterDocument::problem(const sim_board::RobotDescription& robot,
                                       const simulation::NamedModel& model) const {
  try {
    if (is_gait_) {
      const simulation::Gait gait = simulation::read_gait(YamlFile(file(), yaml_.tree()));
      static_cast<void>(simulation::compile_motion(make_gait_motion(gait, robot, model), model));
    } else {
      static_cast<void>(simulation::compile_robot_parameters(robot_parameters(), model.model));
    }
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

void ParameterDocument::apply_to(simulation::Scenario& scenario) const {
  std::error_code ignored;
  if (!is_gait_) {
    if (fs::equivalent(scenario.robot_parameters.file, file(), ignored))
      scenario.robot_parameters = robot_parameters();
    return;
  }
  if (!scenario.gait || !fs::equivalent(scenario.gait->file, file(), ignored)) return;
  // Before the scenario's own, which replace values of the file.
  std::vector<Override> overrides;
  for (const std::size_t index : changed())
    if (const auto number = value(index))
      overrides.push_back({table_[index].key, table_[index].text(*number), file().string()});
  scenario.gait->overrides.insert(scenario.gait->overrides.begin(), overrides.begin(), overrides.end());
}

}  // namespace koboshi::studio
