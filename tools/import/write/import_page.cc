#include "tools/import/write/import_page.h"

#include <fmt/format.h>

#include "base/table/table.h"
#include "base/text/text.h"
#include "base/text/user_units.h"

namespace koboshi::tools {
namespace {

// Characters that Markdown would read as something else.
std::string plain(const std::string& text) {
  std::string result;
  for (const char c : utf8_line(text)) {
    if (c == '|' || c == '<' || c == '`' || c == '*' || c == '_' || c == '[') result += '\\';
    result += c;
  }
  return result;
}

std::string list(const std::string& title, const std::vector<std::string>& lines) {
  if (lines.empty()) return {};
  std::string text = "\n## " + title + "\n\n";
  for (const std::string& line : lines) text += "- " + plain(line) + "\n";
  return text;
}

std::string joints_table(const ImportedRobot& robot, const RobotFileParts& parts,
                         const Interview& interview) {
  std::vector<Row> rows;
  for (const std::size_t index : joints_from_root(robot)) {
    const ImportedJoint& joint = robot.joints[index];
    const auto source = interview.taken.joints.find(joint.name);
    const auto servo = parts.servos.find(joint.name);
    rows.push_back({plain(joint.name), source == interview.taken.joints.end() ? "" : plain(source->second),
                    fmt::format("{:.0f} to {:.0f}", kDegreesPerRad * *joint.lower_rad,
                                kDegreesPerRad * *joint.upper_rad),
                    joint.is_follower ? "that of " + plain(joint.mimics)
                                      : plain(servo == parts.servos.end() ? parts.servo : servo->second)});
  }
  return "\n## Joints\n\n" +
         table_text({"joint", "joint of the source", "range [deg]", "servo"}, rows, TableStyle::kMarkdown);
}

std::string links_table(const ImportedRobot& robot) {
  std::vector<Row> rows;
  for (const ImportedLink& link : robot.links) {
    const std::string box =
        link.collisions.empty()
            ? ""
            : fmt::format("{:.0f} x {:.0f} x {:.0f}", kMmPerM * link.collisions.front().size_m.x(),
                          kMmPerM * link.collisions.front().size_m.y(),
                          kMmPerM * link.collisions.front().size_m.z());
    rows.push_back({plain(link.name), fmt::format("{:.1f}", 1000.0 * link.mass_kg), box});
  }
  return "\n## Links\n\n" + table_text({"link", "mass [g]", "box [mm]"}, rows, TableStyle::kMarkdown);
}

std::string repairs_table(const ImportReport& report) {
  if (report.repairs.empty()) return {};
  std::vector<Row> rows;
  for (const ImportRepair& repair : report.repairs)
    rows.push_back({plain(repair.key), plain(repair.found), repair.is_kept ? "kept" : plain(repair.taken),
                    plain(repair.because)});
  return "\n## Repairs\n\n" +
         table_text({"repair", "found", "taken", "because"}, rows, TableStyle::kMarkdown);
}

std::string answers_table(const Interview& interview) {
  std::vector<Row> rows;
  for (const ImportQuestion& question : interview.questions())
    rows.push_back(
        {plain(question.name), plain(question.text), plain(interview.taken.answers.at(question.name))});
  return "\n## Questions\n\n" + table_text({"name", "question", "answer"}, rows, TableStyle::kMarkdown);
}

}  // namespace

std::string import_page(const ImportedRobot& robot, const RobotFileParts& parts, const Interview& interview,
                        const ImportReport& report, const std::string& command) {
  return "# Import of " + plain(parts.name) + "\n\nMade from `" + utf8_line(parts.source) + "` by\n\n    " +
         utf8_line(command) + "\n\nEdit `import.yaml` and repeat the command to decide otherwise.\n" +
         list("Warnings", report.warnings) + answers_table(interview) +
         joints_table(robot, parts, interview) + links_table(robot) + repairs_table(report) +
         list("Normalised", report.normalised) + list("Ignored parts of the source", report.ignored);
}

}  // namespace koboshi::tools
