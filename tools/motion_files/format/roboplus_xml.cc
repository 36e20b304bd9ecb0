// .mtnx of ROBOTIS R+ Motion: XML with pages of steps. A step has a frame, in 1/128 s since the start of the
// page, and a pose: the angles of the servos 1, 2, ... in degrees.

#include <tinyxml2.h>

#include <cmath>
#include <string>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "base/xml/xml_parse.h"
#include "tools/motion_files/format/lines.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

constexpr double kFramesPerSecond = 128.0;
constexpr double kMostXmlFrames = 128.0 * 3'600.0;
constexpr std::size_t kMostXmlServos = 254;
constexpr double kMostXmlAngle_deg = 3'600.0;

std::string xml_text(const tinyxml2::XMLElement& element, const char* name) {
  const char* text = element.Attribute(name);
  return text == nullptr ? std::string() : std::string(text);
}

void read_xml_pose(const tinyxml2::XMLElement& step, ForeignFrame& frame, ForeignMotion& motion) {
  const std::string pose = xml_text(step, "pose");
  std::size_t place = 0;
  for (const std::string_view field : split(trimmed(pose), ' ')) {
    if (field.empty()) continue;
    if (place == kMostXmlServos) {
      motion.notes.push_back({frame.place, "has more than 254 angles; the others are ignored"});
      return;
    }
    const int id = static_cast<int>(++place);
    if (place > motion.joints.size())
      motion.joints.push_back({.name = "servo " + std::to_string(id), .servo_id = id});
    auto angle_deg = parse_number(field);
    if (angle_deg && std::abs(*angle_deg) > kMostXmlAngle_deg) angle_deg.reset();
    if (!angle_deg)
      motion.notes.push_back({frame.place, "servo " + std::to_string(id) + " keeps its angle: '" +
                                               one_line(field) + "' is none in degrees"});
    frame.values.push_back(angle_deg ? ForeignValue(*angle_deg * kRadPerDegree) : std::nullopt);
  }
}

// Returns a motion without frames for a page without steps.
ForeignMotion read_xml_page(const tinyxml2::XMLElement& page, int number) {
  ForeignMotion motion{
      .format = MotionFormat::kRoboplusXml, .page = number, .name = one_line(xml_text(page, "name"))};
  motion.notes.push_back({"pose", "its angles are taken for those of the servos 1, 2, ... in this order"});
  ForeignSection section;
  double last = 0.0;
  const tinyxml2::XMLElement* steps = page.FirstChildElement("steps");
  for (const auto* step = steps == nullptr ? nullptr : steps->FirstChildElement("step"); step != nullptr;
       step = step->NextSiblingElement("step")) {
    ForeignFrame frame{.place = line_place(static_cast<std::size_t>(step->GetLineNum()))};
    const std::string text = xml_text(*step, "frame");
    const auto at = parse_number(text);
    if (!at || *at < last || *at > kMostXmlFrames) {
      motion.notes.push_back(
          {frame.place, "ignored: '" + one_line(text) + "' is no frame after the one above"});
      continue;
    }
    frame.move_us = std::llround(1e6 * *at / kFramesPerSecond) - std::llround(1e6 * last / kFramesPerSecond);
    last = *at;
    read_xml_pose(*step, frame, motion);
    section.frames.push_back(std::move(frame));
  }
  for (ForeignFrame& frame : section.frames) frame.values.resize(motion.joints.size());
  if (!section.frames.empty()) motion.sections.push_back(std::move(section));
  return motion;
}

}  // namespace

std::vector<ForeignMotion> read_roboplus_xml(const std::filesystem::path& file, std::string_view text) {
  tinyxml2::XMLDocument document;
  parse_xml_text(document, text, file);
  std::vector<ForeignMotion> motions;
  const tinyxml2::XMLElement* root = document.RootElement();
  const tinyxml2::XMLElement* pages = root == nullptr ? nullptr : root->FirstChildElement("PageRoot");
  int number = 0;
  for (const auto* page = pages == nullptr ? nullptr : pages->FirstChildElement("Page"); page != nullptr;
       page = page->NextSiblingElement("Page")) {
    ForeignMotion motion = read_xml_page(*page, ++number);
    if (!motion.sections.empty()) motions.push_back(std::move(motion));
  }
  if (motions.empty()) throw InputError(file, 0, "no page with a step", "PageRoot with Page, steps and step");
  if (root->FirstChildElement("FlowRoot") != nullptr) {
    for (ForeignMotion& motion : motions)
      motion.notes.push_back({"FlowRoot", "flows, which play several pages, are ignored"});
  }
  return motions;
}

}  // namespace koboshi::tools
