#include "tools/import/decide/decisions_text.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "base/text/text.h"

namespace koboshi::tools {
namespace {

// A text in double quotes if YAML could read it as something else (YAML 1.2.2, 7.3.1).
std::string scalar(const std::string& text) {
  const bool plain = !text.empty() && std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '.' || c == '-' || c == '/';
  });
  const std::set<std::string> reserved{"true", "false", "null", "~", "-", "."};
  if (plain && !reserved.contains(text) && (!parse_number(text) || text == number_text(*parse_number(text))))
    return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

// A name or text of the source that YAML must read as a text even where it looks like a number.
std::string text_scalar(const std::string& text) {
  const std::string plain = scalar(text);
  return plain.starts_with('"') || !parse_number(text) ? plain : "\"" + text + "\"";
}

template <typename Value, typename Format>
std::string section(const std::string& head, const std::string& key,
                    const std::map<std::string, Value>& values, const Format& format) {
  if (values.empty()) return {};
  std::string text = "\n" + head + key + ":\n";
  for (const auto& [name, value] : values) text += "  " + text_scalar(name) + ": " + format(value) + "\n";
  return text;
}

std::string answers_section(const Interview& interview) {
  std::string text = "\n# Answers that no file contains.\nanswers:\n";
  for (const ImportQuestion& question : interview.questions()) {
    text += "  # " + utf8_line(question.text);
    if (!question.choices.empty()) text += " (" + join_alternatives(question.choices) + ")";
    text += "\n  " + question.name + ": " + scalar(interview.taken.answers.at(question.name)) + "\n";
  }
  return text;
}

std::string repairs_section(const ImportReport& report) {
  if (report.repairs.empty()) return {};
  std::string text =
      "\n# Values of the source that were replaced. `keep` keeps one as it is in the source.\nrepairs:\n";
  for (const ImportRepair& repair : report.repairs)
    text +=
        fmt::format("  # {} -> {}, because {}\n  {}: {}\n", utf8_line(repair.found), utf8_line(repair.taken),
                    utf8_line(repair.because), text_scalar(repair.key), repair.is_kept ? "keep" : "take");
  return text;
}

}  // namespace

std::string decisions_text(const Interview& interview, const ImportReport& report,
                           const std::filesystem::path& source) {
  const ImportDecisions& taken = interview.taken;
  const auto angle = [](double value_deg) { return number_text(value_deg); };
  std::string text =
      "# Decisions of `koboshi model import`. Edit them and import again: this file is read first.\n"
      "version: 1\nsource: " +
      text_scalar(source.string()) + "\n";
  text += answers_section(interview);
  text += section("# Joint of robot.sdf: joint of the source.\n", "joints", taken.joints, text_scalar);
  text += section("# Joints of the source that the robot has without a drive, at these angles.\n",
                  "locked_deg", taken.locked_deg, angle);
  text += section("# Angles of the source's joints in the robot's zero pose.\n", "zero_deg", taken.zero_deg,
                  angle);
  text += section("# Ranges of the joints from that pose.\n", "limits_deg", taken.limits_deg,
                  [&](const std::array<double, 2>& limits) {
                    return "[" + angle(limits[0]) + ", " + angle(limits[1]) + "]";
                  });
  text += section("# Servo of each joint.\n", "servos", taken.servos, text_scalar);
  return text + repairs_section(report);
}

}  // namespace koboshi::tools
