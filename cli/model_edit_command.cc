#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/edit/unified_diff.h"
#include "base/file/output_file.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "cli/commands.h"
#include "sim_board/description/edit/field_value.h"
#include "sim_board/description/edit/robot_text.h"
#include "simulation/scenario/paths.h"

namespace koboshi::cli {
namespace {

struct ModelEditArguments {
  std::filesystem::path robot;
  std::vector<std::string> words;  // PATH or PATH=VALUE
  std::filesystem::path out;
  bool both_sides = false;
  bool dry_run = false;
};

void find_robot(ModelEditArguments& arguments) {
  arguments.robot = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
}

sim_board::ModelSetting setting_of(const std::filesystem::path& file, const std::string& word) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(file, 0, one_line(word), "PATH=VALUE, such as left_shank.mass=0.06");
  return {word.substr(0, equals), word.substr(equals + 1)};
}

// A line for each number without a unit. On standard error, as a patch may be on standard output.
std::string assumed_units(const XmlDocument& document, const std::vector<sim_board::ModelSetting>& settings) {
  std::string text;
  for (const sim_board::ModelSetting& setting : settings) {
    const std::string unit = assumed_unit(sim_board::find_field(document, setting.path), setting.value);
    if (!unit.empty()) text += fmt::format("{} = {}, taken as {}\n", setting.path, setting.value, unit);
  }
  return text;
}

void set_model(const ModelEditArguments& arguments) {
  const std::string text = read_text_file(arguments.robot, "an XML file");
  // The robot must load where the result will be: paths of meshes are relative to it.
  const std::filesystem::path out = arguments.out.empty() ? arguments.robot : arguments.out;
  XmlDocument document(out, text);
  std::vector<sim_board::ModelSetting> settings;
  for (const std::string& word : arguments.words) settings.push_back(setting_of(arguments.robot, word));
  const std::string notes = assumed_units(document, settings);
  sim_board::apply_settings(document, settings,
                            arguments.both_sides ? sim_board::Sides::kBoth : sim_board::Sides::kOne);
  write_to_standard_error(notes);
  if (arguments.dry_run) {
    fmt::print("{}", unified_diff(text, document.text(), arguments.robot.string()));
    return;
  }
  if (document.text() != text || !arguments.out.empty()) document.save();
}

std::string range_text(const sim_board::ModelField& field) {
  std::string text = field.expected();
  if (!field.value && !field.fallback().empty()) text += "; default " + field.fallback();
  return text;
}

void print_fields(const XmlDocument& document, const sim_board::ModelElement& element) {
  for (const sim_board::ModelField& field : sim_board::model_fields(document, element)) {
    if (field.part != sim_board::PosePart::kWhole || !field.value) continue;
    fmt::print("{:<44} {:<28} {}\n", field.path, *field.value, range_text(field));
  }
}

void get_model(const ModelEditArguments& arguments) {
  const XmlDocument document(arguments.robot);
  const std::vector<sim_board::ModelElement> elements = sim_board::model_elements(document);
  if (arguments.words.empty()) {
    for (const sim_board::ModelElement& element : elements)
      fmt::print("{} {}\n", sim_board::plain_tag(element.rule->name), element.name);
    return;
  }
  for (const std::string& word : arguments.words) {
    const auto element = std::ranges::find(elements, word, &sim_board::ModelElement::name);
    if (element != elements.end()) {
      print_fields(document, *element);
      continue;
    }
    const sim_board::ModelField field = sim_board::find_field(document, word);
    if (!field.value && field.fallback().empty())
      throw InputError(arguments.robot, 0, field.path + " without a value", "a value that is in the file");
    fmt::print("{}\n", field.value.value_or(field.fallback()));
  }
}

}  // namespace

void add_model_edit_commands(CLI::App& model, Invocation&) {
  auto arguments = std::make_shared<ModelEditArguments>();
  CLI::App* set = model.add_subcommand("set", "Change values in a robot's file");
  set->footer(
      R"(Replaces the bytes of each value: comments, order and layout of the rest stay. PATH is the name of a link,
joint or type of servo, then a key, and names or keys between them where several fit. VALUE ends with its unit
(mm, deg, g), or is in that of the file, which is then printed. An empty VALUE removes an optional one. The
result must load: otherwise nothing is written and the exit status is 2 (docs/reference/model-set.md).

Examples:
  koboshi model set robots/koboshi/robot.sdf left_shank.mass=0.06 left_knee.axis="0 1 0" --dry-run
  koboshi model set robots/koboshi/robot.sdf left_knee.upper="140 deg" --mirror --dry-run
  koboshi model set robots/koboshi/robot.sdf head.helmet.zoom="0.001 0.001 0.0012" --dry-run
)");
  set->add_option("ROBOT", arguments->robot, "The robot's file or name")->required();
  set->add_option("SETTING", arguments->words, "Values to set, each as PATH=VALUE")->required();
  set->add_flag("--mirror", arguments->both_sides, "Also set the mirror image on the other side");
  set->add_flag("--dry-run", arguments->dry_run, "Print the difference and write nothing");
  set->add_option("-o", arguments->out, "Write the result to this file")->type_name("FILE");
  set->callback([arguments] {
    find_robot(*arguments);
    set_model(*arguments);
  });

  CLI::App* get = model.add_subcommand("get", "Print values of a robot's file");
  get->footer(
      R"(PATH is as in koboshi model set. The name of a link, joint or type of servo prints all its values with
units and ranges; without a PATH, the names are printed.

Examples:
  koboshi model get robots/koboshi/robot.sdf left_shank.mass left_foot.friction
  koboshi model get robots/koboshi/robot.sdf left_knee
)");
  get->add_option("ROBOT", arguments->robot, "The robot's file or name")->required();
  get->add_option("PATH", arguments->words, "Values, or names of elements");
  get->callback([arguments] {
    find_robot(*arguments);
    get_model(*arguments);
  });
}

}  // namespace koboshi::cli
