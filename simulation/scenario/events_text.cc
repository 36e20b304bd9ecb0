#include "simulation/scenario/events_text.h"

#include <filesystem>
#include <vector>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "simulation/scenario/paths.h"

namespace koboshi::simulation {
namespace {

std::string seconds(std::uint64_t time_us) { return number_text(static_cast<double>(time_us) / 1e6); }

std::string vector_text(const Eigen::Vector3d& v) {
  return "[" + number_text(v.x()) + ", " + number_text(v.y()) + ", " + number_text(v.z()) + "]";
}

std::string motion_name(const Scenario& scenario, std::size_t motion) {
  return motion < scenario.motions.size() ? scenario.motions[motion].name() : kGaitMotion;
}

std::string stream_text(const Command& command) {
  std::string joints;
  for (const StreamedJoint& streamed : command.stream)
    joints += (joints.empty() ? "" : ", ") + streamed.joint.text + ": " +
              number_text(streamed.target_rad * kDegreesPerRad);
  return joints.empty() ? "{}" : "{joints_deg: {" + joints + "}}";
}

std::string verb_text(const Command& command, const Scenario& scenario) {
  switch (command.kind) {
    case Command::Kind::kEnable:
      return "enable: true";
    case Command::Kind::kPlay:
      return "play: " + motion_name(scenario, command.motion);
    case Command::Kind::kWalk:
      return "walk: {forward_m_per_s: " + number_text(command.velocity.x()) +
             ", left_m_per_s: " + number_text(command.velocity.y()) +
             ", turn_rad_per_s: " + number_text(command.velocity.z()) + "}";
    case Command::Kind::kStop:
      return "stop: true";
    case Command::Kind::kGetUp:
      return "get_up: true";
    case Command::Kind::kEmergencyStop:
      return "emergency_stop: true";
    case Command::Kind::kReset:
      return "reset: true";
    case Command::Kind::kStream:
      return "stream: " + stream_text(command);
  }
  return {};
}

std::string push_text(const Push& push) {
  return "{at_s: " + seconds(push.at_us) + ", duration_s: " + seconds(push.duration_us) +
         ", link: " + push.link.text + ", force_N: " + vector_text(push.force_W_N) +
         (push.p_L_m ? ", at_m: " + vector_text(*push.p_L_m) : "") +
         (push.shape == Push::Shape::kHalfSine ? ", shape: half-sine}" : ", shape: rectangle}");
}

// Returns whether the value at this path of the document is a file name.
bool names_file(const std::string& path) {
  return path == "robot" || path == "parameter_file" || path == "policy" || path == "gait.file" ||
         path.starts_with("motions[") || path.ends_with(".height_field.file");
}

// Rewrites file names relative to one folder as relative to another.
void move_files(YamlNode& node, const std::filesystem::path& from, const std::filesystem::path& to) {
  if (node.kind == YamlNode::Kind::kScalar && names_file(node.path)) {
    const std::filesystem::path file = find_referenced(from, node.scalar);
    if (!file.empty()) node.scalar = std::filesystem::relative(file, to).string();
  }
  for (YamlNode& item : node.items) move_files(item, from, to);
}

}  // namespace

std::string played_text(const Scenario& played, const std::filesystem::path& folder) {
  YamlNode document = played.document;
  std::erase_if(document.items, [](const YamlNode& item) {
    return item.key == "duration_s" || item.key == "commands" || item.key == "pushes" || item.key == "teleop";
  });
  move_files(document, played.file.parent_path(), folder);
  return "# A run of " + played.file.filename().string() +
         ", with what its operator did: `koboshi run` repeats it.\n" + yaml_text(document) +
         events_text(played);
}

YamlNode with_moved_files(YamlNode document, const std::filesystem::path& from,
                          const std::filesystem::path& to) {
  move_files(document, from, to);
  return document;
}

std::string events_text(const Scenario& scenario) {
  std::string text = "duration_s: " + seconds(scenario.duration_us) + "\n";
  if (!scenario.commands.empty()) text += "commands:\n";
  for (const Command& command : scenario.commands)
    text += "  - {at_s: " + seconds(command.at_us) + ", " + verb_text(command, scenario) + "}\n";
  if (!scenario.pushes.empty()) text += "pushes:\n";
  for (const Push& push : scenario.pushes) text += "  - " + push_text(push) + "\n";
  return text;
}

}  // namespace koboshi::simulation
