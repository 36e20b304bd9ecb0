// The page docs/reference/robot-file.md.

#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "sim_board/description/robot_keys.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "tools/robot_file/reference/reference.h"

namespace koboshi::tools {
namespace {

using sim_board::RobotKey;

// A table of the page: the keys below `path` that belong to no later, deeper section.
struct PageSection {
  std::string_view path;
  std::string_view title;
  std::string_view text;
};

constexpr std::array kSections{
    PageSection{"", "Model", "The children of `<model>`."},
    PageSection{"koboshi:servo_type", "Servo type",
                "[Servo](servo.md) has the equations, and the models M1 to M6 of friction."},
    PageSection{"link", "Link", "Masses and inertias come from the parts list or from CAD."},
    PageSection{"link/collision", "Collision", "[Ground](ground.md) has the equations of contacts."},
    PageSection{"link/visual", "Visual", "[Meshes](meshes.md) has an example."},
    PageSection{"link/sensor", "Inertial unit",
                "[Sensors](sensors.md) has the signal chain. The densities come from the data sheet."},
    PageSection{"joint", "Joint", "[Frames](../design/frames.md) has joint zero and the signs."},
    PageSection{"frame", "Frame",
                "A frame is a place with a name, such as a mounting point. Frames may be nested: one may be "
                "attached to\nanother, or have its pose in another's axes."},
    PageSection{"joint/sensor", "Ankle sensor", "The force/torque sensor of a joint whose child is a foot."},
};

constexpr std::string_view kIntroduction = R"(# Robot file

This page lists every key of a robot's file, with unit, values, default and meaning. The file is SDF,
of a version from 1.5 to 1.9, without a name space, and what SDF lacks is in `koboshi:` elements.
`robots/koboshi/robot.sdf` is an example. `koboshi model reference write` generates this page and the
schemas below from the table by which the reader checks a file.

- Units are SI units and radians. Frames: x forward, y left, z up ([frames](../design/frames.md)).
- The text is UTF-8. A text value (a name, a reference, a path) has no control characters, and no white
  space at either end.
- A value that no robot of this size has is refused, with the unit that was probably meant: 45 kg for a
  shank (R030 of the [check](model-check.md)).
- The elements of a group may be in any order. An element or attribute that is not listed here is an
  error, because it would have no effect.
- A path such as `inertial/mass` names elements from the outside to the inside; `@` precedes an
  attribute.
- Default: the value of a missing key. *Required* keys must be there, *any number* may repeat or be
  missing; for *optional* keys the meaning states what holds without them.
- References to frames follow SDF 1.9: a name is that of a link, joint or frame, and `__model__` is the
  model's own frame. A key that the meaning restricts to SDF 1.5 and 1.6 is an error in later versions
  ([decision 22](../decision/0022-robot-files-without-libsdformat.md)).
- Source: the document that defines the quantity; `.md` pages are in this folder or in `../design`.

Editors and `xmllint` check a file as you write it by [robot.xsd](robot.xsd), which imports
[robot-koboshi.xsd](robot-koboshi.xsd) for the `koboshi:` elements and for libraries of servo types
([decision 21](../decision/0021-schema-of-the-robot-file.md)):

    xmllint --noout --schema docs/reference/robot.xsd robots/koboshi/robot.sdf

A schema sees names, values, and references to links, not physics. `koboshi model check` also finds
inertias of no rigid body, axes that are no unit vectors, limits in the wrong order, missing meshes and
more ([model check](model-check.md)).
)";

std::string cell(std::string text) {
  for (std::size_t place = text.find('|'); place != std::string::npos; place = text.find('|', place + 2))
    text.insert(place, "\\");
  return text;
}

// "`1` or `-1`".
std::string quoted_alternatives(const std::vector<std::string>& choices) {
  std::vector<std::string> quoted;
  for (const std::string& choice : choices) quoted.push_back("`" + choice + "`");
  return join_alternatives(quoted);
}

// "1e-06 to 1000", "3 times -1 to 1", "`imu`".
std::string values_text(const RobotKey& key) {
  if (key.content == XmlContent::kAnything) return "any";
  if (!key.choices.empty()) return quoted_alternatives(key.choices);
  std::string text = describe_values(key);
  for (const std::string_view noise : {"a number from ", "a number of ", "a whole number from "}) {
    const std::size_t place = text.find(noise);
    if (place == std::string::npos) continue;
    text.replace(place, noise.size(), noise.starts_with("a whole") ? "whole, " : "");
  }
  return text;
}

std::string default_text(const RobotKey& key) {
  if (key.count == XmlCount::kRequired) return "required";
  if (key.count == XmlCount::kRepeated) return "any number";
  return key.note.fallback.empty() ? "optional" : "`" + key.note.fallback + "`";
}

// The deepest section that contains a key; a section's own element belongs to the section around it.
std::string_view section_of(const RobotKey& key) {
  std::string_view deepest;
  for (const PageSection& section : kSections) {
    const std::string_view path = key.path;
    const bool inside = path.starts_with(section.path) && path.size() > section.path.size() &&
                        (path[section.path.size()] == '/' || path[section.path.size()] == '@');
    if (inside && section.path.size() > deepest.size()) deepest = section.path;
  }
  return deepest;
}

std::string section_text(const PageSection& section) {
  std::string text = fmt::format("\n## {}\n\n{}\n\n", section.title, section.text);
  text += "| key | unit | values | default | meaning | source |\n| --- | --- | --- | --- | --- | --- |\n";
  for (const RobotKey& key : sim_board::robot_keys()) {
    if (section_of(key) != section.path) continue;
    std::string name = key.path.substr(section.path.size());
    if (name.starts_with('/')) name.erase(0, 1);
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", name, key.note.unit, cell(values_text(key)),
                        default_text(key), cell(key.note.meaning), key.note.source);
  }
  return text;
}

}  // namespace

std::string robot_page_text() {
  std::string text{kIntroduction};
  const XmlRule& sdf = sim_board::sdf_rule();
  text += "\n## File\n\n| key | values | default | meaning |\n| --- | --- | --- | --- |\n";
  for (const XmlAttributeRule& attribute : sdf.attributes)
    text += fmt::format("| `sdf@{}` | {} | {} | {} |\n", attribute.name,
                        attribute.choices.empty() ? "a text" : quoted_alternatives(attribute.choices),
                        attribute.required ? "required" : "optional", attribute.note.meaning);
  for (const PageSection& section : kSections) text += section_text(section);
  return text;
}

}  // namespace koboshi::tools
