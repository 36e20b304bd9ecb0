// The keys of a joint: axis, limits, servo, encoder, drive, role.

#include "sim_board/description/schema/roles.h"
#include "sim_board/description/schema/schema_rules.h"

namespace koboshi::sim_board {
namespace {

using enum XmlContent;

const std::string kMimicSource = "SDF 1.11; decision 46";
using enum XmlCount;

// A joint with it has no servo, encoder and drive.
const std::string kMimic = "axis/mimic";

XmlRule not_of_followers(XmlRule rule) {
  rule.unless = kMimic;
  rule.note.meaning += "; none for a joint that has `mimic`";
  return rule;
}

XmlRule mimic() {
  constexpr NumberRange kAngle_rad{.min = -3.2, .max = 3.2};
  return group_rule(
      "mimic", kOptional,
      {.meaning =
           "the motor of another joint turns this one as well: angle = multiplier * (angle of that joint - "
           "reference) + offset; the range is that which the other joint's leaves it, whatever `limit` says",
       .source = kMimicSource},
      {number_rule(
           "multiplier", kRequired, {.min = -8, .max = 8},
           {"1", "", "turns of this joint per turn of the other one, not within 0.05 of zero", kMimicSource}),
       number_rule("offset", kOptional, kAngle_rad,
                   {"rad", "0", "angle of this joint where the other one is at `reference`", kMimicSource}),
       number_rule("reference", kOptional, kAngle_rad,
                   {"rad", "0", "angle of the other joint", kMimicSource})},
      {text_attribute("joint", true,
                      {.meaning = "name of the other joint, which has a drive and no other follower",
                       .source = kMimicSource})});
}

XmlRule axis() {
  constexpr NumberRange kLimit_rad{.min = -1000, .max = 1000};
  XmlRule xyz =
      numbers_rule("xyz", kRequired, 3, {.min = -1, .max = 1},
                   {"1", "", "unit vector along the axis, about which the joint turns right-handed", kSdf});
  xyz.attributes = {text_attribute(
      "expressed_in", false,
      {.meaning =
           "name of the link, joint or frame in whose axes the vector is given; without it, the joint's own",
       .source = kSdf})};
  return group_rule(
      "axis", kRequired, {.meaning = "axis and range of the joint", .source = kSdf},
      {std::move(xyz), mimic(),
       group_rule("limit", kRequired, {.meaning = "range and speed", .source = kSdf},
                  {number_rule("lower", kRequired, kLimit_rad,
                               {"rad", "", "lower end of the range, below the upper one", kSdf}),
                   number_rule("upper", kRequired, kLimit_rad, {"rad", "", "upper end of the range", kSdf}),
                   number_rule("velocity", kRequired, {.min = 1e-3, .max = 1000},
                               {"rad/s", "", "largest speed", kSdf})}),
       text_rule("use_parent_model_frame", kOptional,
                 {.fallback = "false",
                  .meaning = "expressed_in=\"__model__\" in files of SDF 1.5 and 1.6",
                  .source = "SDF 1.6"},
                 {"true", "false", "1", "0", "True", "False", "TRUE", "FALSE"})});
}

XmlRule servo() {
  return attributes_rule(
      "koboshi:servo", kRequired, {.meaning = "servo of the joint", .source = kServoPage},
      {text_attribute("type", true,
                      {.meaning = "name of a koboshi:servo_type of this file or of an included library",
                       .source = kServoPage}),
       number_attribute(
           "gear", false, {.min = 0.02, .max = 50},
           {"1", "1", "turns of the servo's output shaft per turn of the joint, by a stage between them",
            kServoPage})});
}

XmlRule encoder() {
  return attributes_rule("koboshi:encoder", kRequired,
                         {.meaning = "encoder, in turns of the joint", .source = kServoPage},
                         {integer_attribute("bits", true, {.min = 8, .max = 24},
                                            {"1", "", "a turn has 2^bits counts", kServoPage}),
                          number_attribute("offset_rad", false, {.min = -1, .max = 1},
                                           {"rad", "0", "error of the encoder's mounting", kServoPage}),
                          number_attribute("noise_counts", false, {.min = 0, .max = 1e4},
                                           {"counts", "0", "standard deviation of a sample", kServoPage})});
}

XmlRule drive() {
  constexpr NumberRange kUnsigned32{.min = 0, .max = 4294967295.0};
  return attributes_rule(
      "koboshi:drive", kRequired,
      {.meaning = "CANopen node of the joint's drive", .source = "CiA 301; CiA 402"},
      {integer_attribute(
           "node_id", true, {.min = 1, .max = 127},
           {"1", "",
            "node id, unique, not 1 or 2 (controller) or 36 to 38 (sensors); the joints' order is "
            "that of their node ids",
            "CiA 301"}),
       integer_attribute(
           "vendor_id", false, kUnsigned32,
           {"1", "1263485513", "vendor id; the default, 4B4F4249h, belongs to nobody", kCanopen}),
       integer_attribute("product_code", false, kUnsigned32, {"1", "1", "product code", kCanopen}),
       integer_attribute("serial_number", true, kUnsigned32, {"1", "", "serial number", kCanopen}),
       {"sign",
        kInteger,
        false,
        {},
        {"1", "-1"},
        {"1", "1", "shaft angle = sign * joint angle + zero_rad", "frames.md"}},
       number_attribute(
           "zero_rad", false, {.min = -3.2, .max = 3.2},
           {"rad", "0",
            "shaft angle at joint angle zero; the shaft must stay within half a turn to either side",
            "frames.md"})});
}

XmlRule role() {
  return text_rule("koboshi:role", kOptional,
                   {.meaning = "place of the joint in a humanoid, by which firmware and motions refer to it; "
                               "without it, the joint's name",
                    .source = "model-map.md"},
                   role_names());
}

XmlRule mirror() {
  return text_rule(
      "koboshi:mirror", kOptional,
      {.meaning = "name of the joint of the other side; without it, the one whose role differs in "
                  "`left_` and `right_` only",
       .source = "model-map.md"});
}

XmlRule maker() {
  return attributes_rule(
      "koboshi:maker", kOptional,
      {.meaning = "the joint in motion files of the robot's maker", .source = "model-map.md"},
      {integer_attribute("servo_id", true, {.min = 0, .max = 255},
                         {"1", "", "number of the servo, unique", "model-map.md"}),
       {"sign",
        kInteger,
        false,
        {},
        {"1", "-1"},
        {"1", "1", "ticks = zero_ticks + sign * joint angle / (2 pi) * ticks_per_turn", "model-map.md"}},
       number_attribute("zero_ticks", false, {.min = -1e6, .max = 1e6},
                        {"ticks", "2048", "position at joint angle zero", "model-map.md"}),
       number_attribute("ticks_per_turn", false, {.min = 1, .max = 1e7},
                        {"ticks", "4096", "ticks of a whole turn", "model-map.md"})});
}

}  // namespace

XmlRule joint_rule() {
  return group_rule(
      "joint", kRepeated,
      {.meaning = "a hinge between two links; the joints form one tree of all links", .source = kSdf},
      {pose_rule("the frame that child names"),
       text_rule("parent", kRequired,
                 {.meaning = "name of the link on the trunk's side, or of a frame that is attached to it",
                  .source = kSdf}),
       text_rule("child", kRequired,
                 {.meaning = "name of the link that the joint moves, or of a frame that is attached to it",
                  .source = kSdf}),
       axis(), not_of_followers(servo()), not_of_followers(encoder()), not_of_followers(drive()), role(),
       mirror(), maker(), ankle_rule()},
      {name_attribute("name of the joint, unique among links, joints and frames; a role if koboshi:role "
                      "states no other"),
       text_attribute("type", true, {.meaning = "kind of joint", .source = kSdf}, {"revolute"})});
}

}  // namespace koboshi::sim_board
