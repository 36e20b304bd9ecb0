#include "tools/manual/command_table.h"

#include <fmt/format.h>

#include <sstream>
#include <utility>

namespace koboshi::tools {

std::string Command::joined(const std::string& separator) const {
  return fmt::format("{}", fmt::join(words, separator));
}

std::vector<Command> all_commands(const CLI::App& program, std::vector<std::string> words) {
  std::vector<Command> commands{{&program, words}};
  for (const CLI::App* below : subcommands(program)) {
    std::vector<std::string> path = words;
    path.push_back(below->get_name());
    const std::vector<Command> more = all_commands(*below, std::move(path));
    commands.insert(commands.end(), more.begin(), more.end());
  }
  return commands;
}

std::vector<const CLI::App*> subcommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* below) { return !below->get_group().empty(); });
}

std::vector<const CLI::Option*> positionals(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::vector<const CLI::Option*> options(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->nonpositional(); });
}

std::vector<std::string> option_names(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::string placeholder(const CLI::Option& option) {
  return option.get_type_size() == 0 ? std::string() : option.get_type_name();
}

// CLI11 keeps the set of IsMember only as the text "{a,b,c}" behind the placeholder.
std::vector<std::string> choices(const CLI::Option& option) {
  const std::string type = placeholder(option);
  const std::size_t begin = type.find('{');
  if (begin == std::string::npos || type.back() != '}') return {};
  std::istringstream list(type.substr(begin + 1, type.size() - begin - 2));
  std::vector<std::string> words;
  for (std::string word; std::getline(list, word, ',');) words.push_back(word);
  return words;
}

}  // namespace koboshi::tools
