#include "tools/manual/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>
#include <vector>

namespace koboshi::tools {
namespace {

// man(7) reads a backslash as an escape, a hyphen as typographic, and a line with a leading dot or quote as a
// request.
std::string roff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (escaped.empty() || escaped.back() == '\n')) escaped += "\\&";
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string bold(const std::string& text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(const std::string& text) { return text.empty() ? "" : "\\fI" + roff(text) + "\\fR"; }

// A placeholder, whose list of words may break after each comma.
std::string value_text(const CLI::Option& option) {
  std::string text = italic(placeholder(option));
  for (std::size_t at = text.find(','); at != std::string::npos; at = text.find(',', at + 1))
    text.insert(at + 1, "\\:");
  return text;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

bool is_indented(const std::string& line) { return line.starts_with("  "); }

// Prose as paragraphs, indented lines as they are.
std::string body(const std::vector<std::string>& lines) {
  std::string text;
  bool literal = false;
  const auto set_literal = [&](bool wanted) {
    if (wanted != literal) text += wanted ? ".PP\n.RS 4\n.nf\n" : ".fi\n.RE\n.PP\n";
    literal = wanted;
  };
  for (const std::string& line : lines) {
    if (line.empty()) {
      set_literal(false);
      text += ".PP\n";
    } else {
      set_literal(is_indented(line));
      text += roff(literal ? line.substr(2) : line) + "\n";
    }
  }
  set_literal(false);
  while (text.ends_with("\n.PP\n")) text.erase(text.size() - 4);
  return text == ".PP\n" ? std::string() : text;
}

struct Footer {
  std::vector<std::string> description;
  std::vector<std::string> examples;
};

Footer split(const std::string& text) {
  Footer footer;
  std::istringstream stream(text);
  std::vector<std::string>* part = &footer.description;
  for (std::string line; std::getline(stream, line);) {
    if (line == "Example:" || line == "Examples:") {
      part = &footer.examples;
    } else {
      if (line.starts_with("Example, ")) part = &footer.examples;
      part->push_back(line);
    }
  }
  return footer;
}

// The names of options in alphabetical order: CLI11 keeps sets of pointers, whose order differs from run to
// run.
std::string names_of(const std::set<CLI::Option*>& options) {
  std::set<std::string> names;
  for (const CLI::Option* option : options) {
    const std::vector<std::string> typed = option_names(*option);
    names.insert(typed.empty() ? italic(option->get_name(true)) : bold(typed.back()));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string description_of(const CLI::Option& option) {
  std::string text = option.get_description();
  std::ranges::replace(text, '\n', ' ');
  text = roff(text);
  if (!text.ends_with('.')) text += ".";
  if (!option.get_default_str().empty()) text += " Default: " + roff(option.get_default_str()) + ".";
  if (!option.get_positional() && option.get_required()) text += " Required.";
  if (!option.get_needs().empty()) text += " Only with " + names_of(option.get_needs()) + ".";
  if (!option.get_excludes().empty()) text += " Not with " + names_of(option.get_excludes()) + ".";
  return text;
}

std::string positional_usage(const CLI::Option& option) {
  std::string text = italic(option.get_name(true));
  if (option.get_expected_max() == CLI::detail::expected_max_vector_size) text += " ...";
  return option.get_required() ? text : "[" + text + "]";
}

std::string synopsis(const Command& command) {
  std::string text = bold(command.joined(" "));
  if (!options(*command.app).empty()) text += " [" + italic("OPTIONS") + "]";
  for (const CLI::Option* option : positionals(*command.app)) text += " " + positional_usage(*option);
  if (!subcommands(*command.app).empty()) text += " " + italic("COMMAND") + " ...";
  return text + "\n";
}

std::string options_text(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : positionals(app)) {
    const std::string value = value_text(*option);
    text += fmt::format(".TP\n{}{}\n{}\n", italic(option->get_name(true)), value.empty() ? "" : " " + value,
                        description_of(*option));
  }
  for (const CLI::Option* option : options(app)) {
    std::vector<std::string> names;
    for (const std::string& name : option_names(*option)) names.push_back(bold(name));
    std::string value = value_text(*option);
    if (!value.empty()) value = option->get_expected_min() == 0 ? " [" + value + "]" : " " + value;
    text += fmt::format(".TP\n{}{}\n{}\n", fmt::join(names, ", "), value, description_of(*option));
  }
  return text;
}

std::string commands_text(const Command& command) {
  std::string text;
  for (const CLI::App* below : subcommands(*command.app)) {
    text += fmt::format(".TP\n{}\n{}.\nSee {}(1).\n", bold(below->get_name()), roff(below->get_description()),
                        bold(command.joined("-") + "-" + below->get_name()));
  }
  return text;
}

std::string section(const std::string& title, const std::string& text) {
  return text.empty() ? std::string() : ".SH " + title + "\n" + text;
}

std::string see_also(const Command& command) {
  std::vector<std::string> pages;
  if (command.words.size() > 1) {
    Command parent = command;
    parent.words.pop_back();
    pages.push_back(bold(parent.joined("-")) + "(1)");
    if (parent.words.size() > 1) pages.push_back(bold(command.words.front()) + "(1)");
  }
  return fmt::format("{}{}The documentation is in {}.\n", fmt::join(pages, ",\n"),
                     pages.empty() ? "" : "\n.PP\n", italic("/usr/share/doc/koboshi"));
}

// Only on the program's own page.
std::string files_text() {
  return ".TP\n" + italic("./scenarios, ./robots, ./studies") +
         "\nInputs that are named without a path, such as \\fBwalk\\fR for \\fIscenarios/walk.yaml\\fR, are "
         "searched here\n"
         "and in the nearest parent folder with such folders;\n.TP\n" +
         italic("$XDG_DATA_HOME/koboshi") + ", " + italic("~/.local/share/koboshi") +
         "\nthen in the same folders of the user's own;\n.TP\n" + italic("/usr/share/koboshi") +
         "\nthen in those that come with the program.\n.TP\n" + italic("./runs") +
         "\nResults, unless \\fB\\-\\-out\\fR names another folder.\n.TP\n" + italic("~/.config/Koboshi") +
         "\nSettings of the studio (\\fI$XDG_CONFIG_HOME\\fR).\n.TP\n" + italic("~/.local/state/koboshi") +
         "\nUnsaved documents of the studio (\\fI$XDG_STATE_HOME\\fR).\n";
}

}  // namespace

std::string manual_page(const Command& command, const PageContext& context) {
  const bool is_program = command.words.size() == 1;
  const Footer footer = split(command.app->get_footer());
  std::string summary = command.app->get_description();
  if (summary.ends_with('.')) summary.pop_back();
  std::string text = fmt::format(".TH \"{}\" 1 \"{}\" \"koboshi {}\" \"Koboshi\"\n",
                                 roff(upper(command.joined("-"))), roff(context.date), roff(context.version));
  // Neither hyphenated nor justified: most lines are names of options.
  text += ".nh\n.ad l\n";
  text += section("NAME", roff(command.joined("-")) + " \\- " + roff(summary) + "\n");
  text += section("SYNOPSIS", synopsis(command));
  text += section("DESCRIPTION", body(footer.description));
  text += section("COMMANDS", commands_text(command));
  text += section("OPTIONS", options_text(*command.app));
  text += section("EXAMPLES", body(footer.examples));
  if (is_program) text += section("FILES", files_text());
  text += section("\"SEE ALSO\"", see_also(command));
  return text;
}

}  // namespace koboshi::tools
