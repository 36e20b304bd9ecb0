#include "sim_board/description/schema/sdf_schema.h"

#include "sim_board/description/schema/schema_rules.h"

namespace koboshi::sim_board {
namespace {

using enum XmlCount;

XmlAttributeRule name_space() {
  return text_attribute("xmlns:koboshi", false,
                        {.meaning = "name space of the koboshi: elements, " + std::string(kKoboshiNamespace),
                         .source = "robot-file.md"});
}

XmlRule battery() {
  return attributes_rule(
      "koboshi:battery", kOptional,
      {.meaning = "common supply of all servos; without it, each servo has its own", .source = kServoPage},
      {number_attribute("open_circuit_V", true, {.min = 0.1, .max = 1000},
                        {"V", "", "voltage without load", kServoPage}),
       number_attribute("internal_resistance_ohm", true, {.min = 0, .max = 100},
                        {"ohm", "", "resistance of cells, switch and wires", kServoPage})});
}

// Imports the servo types of a library.
XmlRule servo_library() {
  return attributes_rule(
      "koboshi:servo_types", kRepeated,
      {.meaning = "includes the servo types of a library", .source = kServoPage},
      {text_attribute(
          "file", true,
          {.meaning = "the library, relative to the folder of the robot's file", .source = kServoPage})});
}

// Where the robot stands is a matter of the scenario.
XmlRule model_pose() {
  XmlRule rule = fixed_pose_rule("the world");
  rule.note.fallback = "";
  rule.note.meaning = "accepted without effect: a scenario puts the robot in its place";
  return rule;
}

XmlRule model_rule() {
  return group_rule(
      "model", kRequired, {.meaning = "the robot", .source = kSdf},
      {servo_library(), servo_type_rule(), battery(), link_rule(), joint_rule(), frame_rule(), model_pose()},
      {name_attribute("name of the robot"),
       text_attribute("canonical_link", false,
                      {.meaning = "name of the link to which the model's frame is attached; without it, the "
                                  "first one",
                       .source = kSdf}),
       text_attribute("placement_frame", false,
                      {.meaning = "name of the link, joint or frame that the model's pose places; without "
                                  "effect, as that pose",
                       .source = kSdf})});
}

}  // namespace

const XmlRule& sdf_rule() {
  static const XmlRule rule = group_rule(
      "sdf", kOptional, {.meaning = "root of the file", .source = kSdf}, {model_rule()},
      {text_attribute("version", true, {.meaning = "version of SDF", .source = kSdf}, kSdfVersions),
       name_space()});
  return rule;
}

const XmlRule& servo_library_rule() {
  static const XmlRule rule = group_rule(
      "koboshi:servo_types", kOptional, {.meaning = "root of a library of servo types", .source = kServoPage},
      {servo_type_rule()}, {name_space()});
  return rule;
}

InputError with_import_advice(const InputError& error) {
  const bool is_urdf = error.found() == "<robot>";
  if (!is_urdf && error.found() != "<mujoco>") return error;
  return {error.file(), error.line(), is_urdf ? "a URDF" : "a MuJoCo model",
          "a robot.sdf; make it with: koboshi model import " + error.file().string() + " -o robots/NAME"};
}

}  // namespace koboshi::sim_board
