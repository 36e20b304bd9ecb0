// The keys of frames and links: inertia, collisions, visuals.

#include "sim_board/description/schema/schema_rules.h"

namespace koboshi::sim_board {
namespace {

using enum XmlContent;
using enum XmlCount;

XmlRule moment(const std::string& axis, NumberRange range, XmlCount count) {
  const bool product = axis[0] != axis[1];
  return number_rule("i" + axis, count, range,
                     {"kg m^2", product ? "0" : "",
                      product ? "product of inertia, the element of the matrix in row " + axis.substr(0, 1) +
                                    " and column " + axis.substr(1)
                              : "moment of inertia about " + axis.substr(0, 1) +
                                    "; no principal moment may exceed the sum of the other two",
                      kSdf});
}

XmlRule inertial() {
  return group_rule(
      "inertial", kRequired, {.meaning = "mass and inertia of the link", .source = kSdf},
      {fixed_pose_rule("the link's frame: the centre of mass, and the axes of the inertia"),
       number_rule("mass", kRequired, {.min = 1e-6, .max = 1000}, {"kg", "", "mass of the link", kSdf}),
       group_rule("inertia", kRequired,
                  {.meaning = "inertia matrix about the centre of mass", .source = kSdf},
                  {moment("xx", kNotNegativeRange, kRequired), moment("yy", kNotNegativeRange, kRequired),
                   moment("zz", kNotNegativeRange, kRequired), moment("xy", {}, kOptional),
                   moment("xz", {}, kOptional), moment("yz", {}, kOptional)})});
}

XmlRule box(XmlCount count) {
  // Lengths of robots from table-top to human size.
  constexpr NumberRange kSize{.min = 1e-4, .max = 10};
  return group_rule("box", count, {.meaning = "a box with its centre in the origin", .source = kSdf},
                    {numbers_rule("size", kRequired, 3, kSize, {"m", "", "lengths along x, y and z", kSdf})});
}

XmlRule mesh() {
  return group_rule(
      "mesh", kOptional, {.meaning = "triangles from a file", .source = kSdf},
      {text_rule("uri", kRequired,
                 {.meaning = "STL file, binary or ASCII, relative to the folder of the robot's file",
                  .source = "meshes.md"}),
       numbers_rule(
           "scale", kOptional, 3, {.min = 1e-6, .max = 1000},
           {"1", "1 1 1", "zoom along the mesh's x, y and z: 0.001 for a file in millimetres", kSdf})});
}

// Only the diffuse colour is used; the other elements of SDF's materials are accepted.
XmlRule material() {
  XmlRule rule =
      group_rule("material", kOptional, {.meaning = "colour of the visual", .source = kSdf},
                 {numbers_rule("diffuse", kOptional, 4, kFractionRange,
                               {"1", "",
                                "red, green, blue (sRGB) and opacity; viewers ignore the opacity and choose "
                                "a colour themselves if the element is missing",
                                kSdf})});
  for (const char* unused : {"ambient", "specular", "emissive", "render_order", "lighting", "double_sided",
                             "script", "shader", "pbr"}) {
    rule.children.push_back({.name = unused,
                             .content = kAnything,
                             .note = {.meaning = "accepted without effect", .source = kSdf}});
  }
  return rule;
}

XmlRule friction() {
  constexpr NumberRange kCoefficient{.min = 0, .max = 10};
  return group_rule(
      "friction", kRequired, {.meaning = "Coulomb friction", .source = kOdeManual},
      {group_rule("ode", kRequired, {.meaning = "values for ODE", .source = kSdf},
                  {number_rule("mu", kRequired, kCoefficient,
                               {"1", "", "coefficient of friction in the first direction", kOdeManual}),
                   number_rule("mu2", kOptional, kCoefficient,
                               {"1", "mu", "coefficient of friction in the second direction", kOdeManual}),
                   numbers_rule("fdir1", kOptional, 3, {.min = -1, .max = 1},
                                {"1", "",
                                 "first direction of friction in the axes of the box, any but zero; without "
                                 "it, the ground's x axis",
                                 kOdeManual})})});
}

XmlRule surface() {
  return group_rule(
      "surface", kRequired, {.meaning = "contact properties", .source = kSdf},
      {friction(),
       group_rule(
           "bounce", kOptional, {.meaning = "rebound after an impact", .source = kOdeManual},
           {number_rule("restitution_coefficient", kRequired, kFractionRange,
                        {"1", "", "coefficient of restitution e", kOdeManual}),
            number_rule("threshold", kRequired, kNotNegativeRange,
                        {"m/s", "", "speed of approach below which there is no rebound", kOdeManual})}),
       group_rule("contact", kRequired,
                  {.meaning = "stiffness and damping of the contact", .source = kOdeManual},
                  {group_rule(
                      "ode", kRequired, {.meaning = "values for ODE", .source = kSdf},
                      {number_rule("soft_cfm", kRequired, kFractionRange,
                                   {"m/s/N", "",
                                    "constraint force mixing (CFM) at the reference step; larger is softer",
                                    kOdeManual}),
                       number_rule("soft_erp", kRequired, kFractionRange,
                                   {"1", "",
                                    "error reduction parameter (ERP) at the reference step: the share of the "
                                    "penetration that one step removes",
                                    kOdeManual})})}),
       number_rule(
           "koboshi:reference_step_s", kOptional, {.min = 1e-6, .max = 0.1},
           {"s", "0.001", "step at which soft_cfm and soft_erp hold; the simulation converts them to its own",
            "ground.md"}),
       text_rule("koboshi:material", kOptional,
                 {.meaning = "name of the material, to which pairs under `materials` of a scenario refer",
                  .source = "ground.md"})});
}

XmlRule geometry(std::string meaning, std::vector<XmlRule> shapes) {
  return group_rule("geometry", kRequired, {.meaning = std::move(meaning), .source = kSdf},
                    std::move(shapes));
}

}  // namespace

XmlRule frame_rule() {
  return group_rule(
      "frame", kRepeated, {.meaning = "a frame, to which poses and joints may refer", .source = kSdf},
      {pose_rule("the frame of attached_to, the model's without it")},
      {name_attribute("name of the frame, unique among links, joints and frames"),
       text_attribute("attached_to", false,
                      {.meaning = "name of the link, joint or frame with which it moves; without it, the "
                                  "canonical link",
                       .source = kSdf})});
}

XmlRule link_rule() {
  return group_rule(
      "link", kRepeated,
      {.meaning = "a rigid body; the base is the link that is no joint's child", .source = kSdf},
      {pose_rule("the model's frame"), inertial(),
       group_rule("collision", kRepeated, {.meaning = "a shape that makes contacts", .source = kSdf},
                  {pose_rule("the link's frame"), geometry("one box", {box(kRequired)}), surface()},
                  {name_attribute("name of the collision, unique in the link")}),
       group_rule("visual", kRepeated,
                  {.meaning = "a shape that viewers show, without effect on the simulation", .source = kSdf},
                  {pose_rule("the link's frame"), geometry("one box or one mesh", {box(kOptional), mesh()}),
                   material()},
                  {name_attribute("name of the visual, unique in the link")}),
       imu_rule()},
      {name_attribute(
          "name of the link, unique among links, joints and frames; `left_` and `right_` mark the sides")});
}

}  // namespace koboshi::sim_board
