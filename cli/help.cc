#include "cli/help.h"

#include <algorithm>
#include <map>
#include <regex>
#include <string_view>
#include <vector>

#include "base/text/text.h"
#include "base/text/units.h"

namespace koboshi::cli {
namespace {

// By an option's first name.
const std::map<std::string, std::string>& placeholders() {
  static const std::map<std::string, std::string> kPlaceholders{
      {"--ablate", "NAME"},        {"--budget-s", "SECONDS"}, {"--can", "BUS"},
      {"--controller", "NAME"},    {"--drop", "METRES"},      {"--duration", "SECONDS"},
      {"--feedback", "NAME"},      {"--first-seed", "N"},     {"--folder", "FOLDER"},
      {"--gait", "FILE"},          {"--gltf", "FILE"},        {"--gaits", "FOLDER"},
      {"--hours", "HOURS"},        {"--html", "FILE"},        {"--id", "IDENTIFIER"},
      {"--image", "FILE"},         {"--json", "FILE"},        {"--kind", "NAME"},
      {"--node", "NODE"},          {"--only", "NAME"},        {"--out", "FOLDER"},
      {"--page", "FILE"},          {"--points", "N"},         {"--record", "HZ"},
      {"--record-lost", "FOLDER"}, {"--robot", "FILE"},       {"--scenario", "FILE"},
      {"--search", "NAME"},        {"--section", "NAME"},     {"--seed", "N"},
      {"--set", "KEY=VALUE"},      {"--start", "FILE"},       {"--stepper", "NAME"},
      {"--steppers", "NAME"},      {"--storage", "FILE"},     {"--time-constant-s", "SECONDS"},
      {"--type", "NAME"},          {"--with", "RUN"},         {"--walk", "SECONDS"},
      {"--interface", "NAME"},     {"--name", "NAME"},        {"--plant", "KEY=VALUE"},
      {"--world", "NAME"},         {"--axes", "NAME"},        {"--factors", "NAME"},
      {"--reference", "FILE"},     {"--budget", "MINUTES"},   {"--candidates", "N"},
      {"--inputs", "FILE"},        {"--others", "NAME"},      {"--shard", "K/N"},
      {"--shards", "ACTION"},      {"--sbatch", "OPTION"},    {"--parallel", "HOSTS"},
      {"--until", "GENERATION"}};
  return kPlaceholders;
}

bool is_type_of_cli11(const std::string& name) {
  return name == "TEXT" || name == "INT" || name == "UINT" || name == "FLOAT" || name == "ENUM" ||
         name == "NUMBER";
}

std::string placeholder_of(const CLI::Option& option, const std::string& type) {
  const auto& names = option.get_lnames();
  const auto found = names.empty() ? placeholders().end() : placeholders().find("--" + names.front());
  if (found != placeholders().end()) return found->second;
  if (type == "INT" || type == "UINT") return "N";
  return type == "FLOAT" ? "NUMBER" : type;
}

void shorten_range(CLI::Option& option) {
  static const std::regex kRange(R"((?:INT|UINT|FLOAT) in \[(.*) - (.*)\])");
  for (int i = 0;; ++i) {
    CLI::Validator* validator = nullptr;
    try {
      validator = option.get_validator(i);
    } catch (const CLI::OptionNotFound&) {
      return;  // CLI11 counts them no other way
    }
    validator->description(std::regex_replace(validator->get_description(), kRange, "$1 to $2"));
  }
}

// Returns the unit of an option whose value has this placeholder; empty if it has none.
std::string unit_of_placeholder(const std::string& placeholder) {
  static const std::map<std::string, std::string> kUnits{
      {"SECONDS", "s"}, {"MS", "ms"}, {"METRES", "m"}, {"HOURS", "h"}};
  const auto found = kUnits.find(placeholder);
  return found == kUnits.end() ? std::string() : found->second;
}

// Lets the value of an option have a unit: --duration 500ms.
void accept_unit(CLI::Option& option, const std::string& unit) {
  option.transform(CLI::Validator(
      [unit](std::string& text) -> std::string {
        const auto typed = split_units(text);
        if (!typed || typed->texts.size() != 1 || typed->unit.empty()) return {};  // a number, or no number
        const auto value = parse_quantity(text, unit);
        if (!value) return "found " + one_line(text) + ", expected a number with " + expected_unit(unit);
        text = number_text(*value);
        return {};
      },
      ""));
}

// The type alone, before its validators' descriptions.
std::string own_type(const CLI::Option& option) {
  const std::string text = option.get_type_name();
  return text.substr(0, text.find(':'));
}

}  // namespace

void name_placeholders(CLI::App& program) {
  for (CLI::Option* option : program.get_options()) {
    const std::string type = own_type(*option);
    if (is_type_of_cli11(type))
      option->type_name(option->get_positional() ? "" : placeholder_of(*option, type));
    shorten_range(*option);
    if (const std::string unit = unit_of_placeholder(own_type(*option)); !unit.empty())
      accept_unit(*option, unit);
  }
  for (CLI::App* command : program.get_subcommands({})) name_placeholders(*command);
}

std::optional<std::string> unknown_command(CLI::App& program, int argc, const char* const* argv) {
  CLI::App* app = &program;
  std::string path = "koboshi";
  for (int i = 1; i < argc; ++i) {
    const std::vector<CLI::App*> commands = app->get_subcommands({});
    const std::string word = argv[i];
    if (commands.empty() || word.starts_with('-')) return std::nullopt;
    const auto found = std::ranges::find(commands, word, [](const CLI::App* c) { return c->get_name(); });
    if (found == commands.end()) {
      std::vector<std::string> names;
      for (const CLI::App* command : commands) names.push_back(command->get_name());
      return path + ": found the unknown command " + one_line(word) + ", expected " +
             expected_names(word, names);
    }
    app = *found;
    path += " " + word;
  }
  return std::nullopt;
}

}  // namespace koboshi::cli
