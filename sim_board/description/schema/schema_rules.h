#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/xml/xml_schema.h"

namespace koboshi::sim_board {

// Parts of the table of a robot file's keys (sdf_schema.h). A note's fields: unit, default, meaning, source.

// Documents that define the keys.
inline const std::string kSdf = "SDF 1.9";
inline const std::string kOdeManual = "SDF 1.9; ODE manual; ground.md";
inline const std::string kServoPage = "servo.md";
inline const std::string kFrictionPaper = "servo.md; BAM, arXiv 2410.08650";
inline const std::string kSensorPage = "sensors.md";
inline const std::string kNoiseStandard = "sensors.md; IEEE Std 952-1997, annex C";
inline const std::string kCanopen = "CiA 301, object 1018h";

// The versions that the reader understands (sdf_version.h).
inline const std::vector<std::string> kSdfVersions{"1.5", "1.6", "1.7", "1.8", "1.9"};

inline constexpr NumberRange kFractionRange{.min = 0, .max = 1};
inline constexpr NumberRange kNotNegativeRange{.min = 0};
// Bound of relative errors: a sensor with a larger error is broken.
inline constexpr NumberRange kErrorShareRange{.min = 0, .max = 0.5};
// Positions and angles that no robot exceeds.
inline constexpr NumberRange kPositionRange{.min = -1000, .max = 1000};

// The types of a joint's sensor.
inline const std::string kForceTorqueType = "force_torque";
inline const std::string kPressureCellsType = "koboshi:pressure_cells";
inline const std::string kContactSwitchType = "koboshi:contact_switch";

// An element with these children.
inline XmlRule group_rule(std::string name, XmlCount count, XmlNote note, std::vector<XmlRule> children,
                          std::vector<XmlAttributeRule> attributes = {}) {
  return {.name = std::move(name),
          .content = XmlContent::kChildren,
          .count = count,
          .attributes = std::move(attributes),
          .children = std::move(children),
          .note = std::move(note)};
}

// An element with this many numbers.
inline XmlRule numbers_rule(std::string name, XmlCount count, std::size_t numbers, NumberRange range,
                            XmlNote note) {
  return {.name = std::move(name),
          .content = XmlContent::kNumbers,
          .count = count,
          .numbers = numbers,
          .range = range,
          .note = std::move(note)};
}

inline XmlRule number_rule(std::string name, XmlCount count, NumberRange range, XmlNote note) {
  return numbers_rule(std::move(name), count, 1, range, std::move(note));
}

// An element with a text: any that is not empty, or one of the choices.
inline XmlRule text_rule(std::string name, XmlCount count, XmlNote note,
                         std::vector<std::string> choices = {}) {
  return {.name = std::move(name),
          .content = XmlContent::kText,
          .count = count,
          .choices = std::move(choices),
          .note = std::move(note)};
}

// An element with attributes only.
inline XmlRule attributes_rule(std::string name, XmlCount count, XmlNote note,
                               std::vector<XmlAttributeRule> attributes) {
  return group_rule(std::move(name), count, std::move(note), {}, std::move(attributes));
}

inline XmlAttributeRule number_attribute(std::string name, bool required, NumberRange range, XmlNote note) {
  return {std::move(name), XmlContent::kNumbers, required, range, {}, std::move(note)};
}

inline XmlAttributeRule integer_attribute(std::string name, bool required, NumberRange range, XmlNote note) {
  return {std::move(name), XmlContent::kInteger, required, range, {}, std::move(note)};
}

inline XmlAttributeRule text_attribute(std::string name, bool required, XmlNote note,
                                       std::vector<std::string> choices = {}) {
  return {std::move(name), XmlContent::kText, required, {}, std::move(choices), std::move(note)};
}

// `meaning`: of the element with the name.
inline XmlAttributeRule name_attribute(std::string meaning) {
  return text_attribute("name", true, {.meaning = std::move(meaning), .source = kSdf});
}

// x y z in m, then roll pitch yaw in rad, in the frame `frame`; rotations about fixed axes, roll first.
inline XmlRule fixed_pose_rule(const std::string& frame) {
  return numbers_rule(
      "pose", XmlCount::kOptional, 6, kPositionRange,
      {"m, rad", "0 0 0 0 0 0",
       "position x, y, z in m and rotation roll, pitch, yaw in rad (about fixed axes, roll first) in " +
           frame,
       kSdf});
}

// The same, with an attribute that names another frame.
inline XmlRule pose_rule(const std::string& frame) {
  XmlRule rule = fixed_pose_rule(frame);
  rule.attributes = {
      text_attribute("relative_to", false,
                     {.meaning = "name of the link, joint or frame in whose axes the pose is given instead",
                      .source = kSdf}),
      text_attribute("frame", false,
                     {.meaning = "relative_to in files of SDF 1.5 and 1.6", .source = "SDF 1.6"})};
  return rule;
}

XmlRule frame_rule();
XmlRule link_rule();
XmlRule joint_rule();
XmlRule imu_rule();    // a link's sensor
XmlRule ankle_rule();  // a joint's sensor
XmlRule servo_type_rule();

}  // namespace koboshi::sim_board
