#include "tools/manual/completion.h"

#include <fmt/format.h>

#include <map>
#include <string_view>
#include <vector>

#include "tools/manual/command_table.h"

namespace koboshi::tools {
namespace {

// The functions that complete; the cases of commands and values go between them.
constexpr std::string_view kBegin = R"(# bash completion for koboshi. `koboshi manual completion` prints it.

_koboshi() {
  local current=${COMP_WORDS[COMP_CWORD]} command= options= words= kind= i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command ${COMP_WORDS[i]}" in
)";
constexpr std::string_view kValues = R"() command+=" ${COMP_WORDS[i]}" ;;
    esac
  done
  case "$command ${COMP_WORDS[COMP_CWORD - 1]}" in
)";
constexpr std::string_view kCommands = R"(    *)
      case $command in
)";
constexpr std::string_view kEnd = R"(      esac ;;
  esac
  if [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
    return
  fi
  case $kind in
    none) ;;
    file) words= ;;
    folder)
      compopt -o filenames
      mapfile -t COMPREPLY < <(compgen -d -- "$current")
      return ;;
    ?*) words=$("${COMP_WORDS[0]}" manual names "$kind" 2>/dev/null) ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  if [[ -n $kind && $kind != none ]]; then
    compopt -o filenames
    local file
    while IFS= read -r file; do COMPREPLY+=("$file"); done < <(compgen -f -- "$current")
  fi
}
complete -F _koboshi koboshi
)";

// Returns how bash completes a value with this placeholder or name of a positional: by a kind of `koboshi
// manual names`, or by file, folder, none.
std::string kind_of(const std::string& name) {
  static const std::map<std::string, std::string, std::less<>> kKinds{
      {"SCENARIO", "scenario"}, {"ROBOT", "robot"}, {"MOTION", "motion"}, {"STUDY", "study"},
      {"GAIT", "robot"},        {"FILE", "file"},   {"FOLDER", "folder"}, {"RUN", "file"},
      {"LOG", "file"},          {"IMAGE", "file"},  {"PATH", "file"},     {"OTHER", "file"},
      {"PREFIX", "file"}};
  const auto found = kKinds.find(name);
  return found == kKinds.end() ? "none" : found->second;
}

// Options that take an input by its name as well.
std::string kind_of_option(const CLI::Option& option) {
  const std::vector<std::string> names = option_names(option);
  if (names.back() == "--robot") return "robot";
  if (names.back() == "--scenario") return "scenario";
  const std::string type = placeholder(option);
  return kind_of(type.substr(0, type.find(':')));
}

std::string quoted(const std::string& path) { return "\"" + path + "\""; }

std::string path_of(const Command& command) {
  std::string path;
  for (std::size_t i = 1; i < command.words.size(); ++i) path += " " + command.words[i];
  return path;
}

// The case of an option with a value.
std::string value_case(const std::string& path, const CLI::Option& option) {
  if (placeholder(option).empty()) return {};
  std::vector<std::string> patterns;
  for (const std::string& name : option_names(option)) patterns.push_back(quoted(path + " " + name));
  const std::vector<std::string> words = choices(option);
  return fmt::format("    {}) kind={}{} ;;\n", fmt::join(patterns, " | "),
                     words.empty() ? kind_of_option(option) : "none",
                     words.empty() ? std::string() : fmt::format(" words='{}'", fmt::join(words, " ")));
}

std::string command_case(const Command& command) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : options(*command.app))
    for (const std::string& name : option_names(*option)) flags.push_back(name);
  std::vector<std::string> words;
  for (const CLI::App* below : subcommands(*command.app)) words.push_back(below->get_name());
  std::string kind = "none";
  for (const CLI::Option* option : positionals(*command.app)) {
    if (const auto accepted = choices(*option); !accepted.empty()) {
      words.insert(words.end(), accepted.begin(), accepted.end());
    } else if (kind == "none") {
      kind = kind_of(option->get_name(true));
    }
  }
  return fmt::format("        {}) kind={} words='{}'\n          options='{}' ;;\n", quoted(path_of(command)),
                     kind, fmt::join(words, " "), fmt::join(flags, " "));
}

}  // namespace

std::string bash_completion(const CLI::App& program) {
  const std::vector<Command> commands = all_commands(program, {"koboshi"});
  std::vector<std::string> paths;
  std::string values;
  std::string cases;
  for (const Command& command : commands) {
    if (command.words.size() > 1) paths.push_back("      " + quoted(path_of(command)));
    for (const CLI::Option* option : options(*command.app)) values += value_case(path_of(command), *option);
    cases += command_case(command);
  }
  return fmt::format("{}{}{}{}{}{}{}", kBegin, fmt::join(paths, " |\\\n"), kValues, values, kCommands, cases,
                     kEnd);
}

}  // namespace koboshi::tools
