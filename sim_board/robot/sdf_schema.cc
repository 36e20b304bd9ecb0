#include "sim_board/robot/sdf_schema.h"

namespace koboshi::sim {
namespace {

using enum XmlContent;
using enum XmlCount;

constexpr NumberRange kFraction{.min = 0, .max = 1};
constexpr NumberRange kNotNegative{.min = 0};
// Bound of relative errors: a sensor with a larger error is broken.
constexpr NumberRange kShare{.min = 0, .max = 0.5};
// Lengths of robots from table-top to human size.
constexpr NumberRange kSize{.min = 1e-4, .max = 10};
constexpr NumberRange kUnsigned32{.min = 0, .max = 4294967295.0};
constexpr NumberRange kPosition{.min = -1000, .max = 1000};

XmlRule group(std::string name, XmlCount count, std::vector<XmlRule> children,
              std::vector<XmlAttributeRule> attributes = {}) {
  return {.name = std::move(name),
          .content = kChildren,
          .count = count,
          .attributes = std::move(attributes),
          .children = std::move(children)};
}

XmlRule number(std::string name, XmlCount count, NumberRange range = {}) {
  return {.name = std::move(name), .content = kNumbers, .count = count, .range = range};
}

XmlRule text(std::string name, XmlCount count) {
  return {.name = std::move(name), .content = kText, .count = count};
}

// x y z in metres, roll pitch yaw in radians.
XmlRule fixed_pose() { return {.name = "pose", .content = kNumbers, .numbers = 6, .range = kPosition}; }

XmlRule pose() {
  XmlRule rule = fixed_pose();
  rule.attributes = {{.name = "relative_to", .required = false}};
  return rule;
}

// An element with attributes only.
XmlRule attributes_only(std::string name, std::vector<XmlAttributeRule> attributes) {
  return {.name = std::move(name), .attributes = std::move(attributes)};
}

XmlRule load_shares(std::string name, const std::string& unit, NumberRange range) {
  return attributes_only(
      std::move(name), {{"motor" + unit, kNumbers, true, range}, {"external" + unit, kNumbers, true, range}});
}

XmlRule stribeck() {
  return attributes_only("stribeck", {{"friction_Nm", kNumbers, true, {.min = 0, .max = 100}},
                                      {"speed_rad_per_s", kNumbers, true, {.min = 1e-3, .max = 1000}},
                                      {"exponent", kNumbers, true, {.min = 0.1, .max = 20}}});
}

XmlRule winding() {
  constexpr NumberRange kTemperature_C{.min = -50, .max = 300};
  return attributes_only("winding",
                         {{"thermal_resistance_K_per_W", kNumbers, true, {.min = 0.01, .max = 1000}},
                          {"heat_capacity_J_per_K", kNumbers, true, {.min = 0.01, .max = 1e4}},
                          {"ambient_C", kNumbers, false, kTemperature_C},
                          {"derating_C", kNumbers, true, kTemperature_C},
                          {"shutdown_C", kNumbers, true, kTemperature_C},
                          {"derated_share", kNumbers, false, kFraction},
                          {"copper_per_K", kNumbers, false, {.min = 0, .max = 0.01}}});
}

XmlRule command() {
  constexpr NumberRange kDelay_ms{.min = 0, .max = 100};
  return attributes_only("command", {{"period_ms", kInteger, false, {.min = 1, .max = 100}},
                                     {"write_delay_ms", kInteger, false, kDelay_ms},
                                     {"read_delay_ms", kInteger, false, kDelay_ms},
                                     {"dead_band_rad", kNumbers, false, {.min = 0, .max = 1}}});
}

// Rule of a scalar sensor; `unit` is that of its values, `difference` that of offsets and noise.
XmlRule meter(std::string name, const std::string& unit, const std::string& difference) {
  constexpr NumberRange kValue{.min = -1000, .max = 1000};
  constexpr NumberRange kError{.min = 0, .max = 100};
  return attributes_only(std::move(name),
                         {{"lowest_" + unit, kNumbers, true, kValue},
                          {"highest_" + unit, kNumbers, true, kValue},
                          {"resolution_" + difference, kNumbers, true, {.min = 1e-6, .max = 100}},
                          {"noise_" + difference, kNumbers, false, kError},
                          {"offset_" + difference, kNumbers, false, kError},
                          {"scale_error", kNumbers, false, kShare},
                          {"sample_period_s", kNumbers, false, {.min = 1e-3, .max = 100}}});
}

XmlRule servo_type() {
  // With a share of 1 or more, friction would grow faster than the load that causes it.
  constexpr NumberRange kShare{.min = 0, .max = 0.99};
  return group("koboshi:servo_type", kRepeated,
               {number("torque_constant_Nm_per_A", kRequired, {.min = 1e-3, .max = 100}),
                number("resistance_ohm", kRequired, {.min = 1e-3, .max = 1000}),
                number("supply_V", kRequired, {.min = 0.1, .max = 1000}),
                number("rotor_inertia_kg_m2", kRequired, {.min = 0, .max = 10}),
                number("coulomb_friction_Nm", kRequired, {.min = 0, .max = 100}),
                number("viscous_friction_Nm_s", kRequired, {.min = 0, .max = 100}),
                number("full_voltage_error_rad", kRequired, {.min = 1e-4, .max = 10}),
                number("velocity_gain_V_s_per_rad", kOptional, {.min = 0, .max = 1000}),
                number("max_duty", kOptional, {.min = 0.01, .max = 1}),
                number("current_limit_A", kOptional, {.min = 1e-3, .max = 1000}), stribeck(),
                load_shares("load_friction", "", kShare), load_shares("stribeck_load_friction", "", kShare),
                load_shares("quadratic_load_friction", "_per_Nm", {.min = 0, .max = 10}),
                number("backlash_rad", kOptional, {.min = 0, .max = 0.5}), winding(), command(),
                meter("voltmeter", "V", "V"), meter("thermometer", "C", "K")},
               {{.name = "name"}});
}

XmlRule battery() {
  return attributes_only("koboshi:battery",
                         {{"open_circuit_V", kNumbers, true, {.min = 0.1, .max = 1000}},
                          {"internal_resistance_ohm", kNumbers, true, {.min = 0, .max = 100}}});
}

// Imports the servo types of a library.
XmlRule servo_library() {
  return {.name = "koboshi:servo_types", .count = kRepeated, .attributes = {{.name = "file"}}};
}

XmlRule inertial() {
  return group("inertial", kRequired,
               {fixed_pose(), number("mass", kRequired, {.min = 1e-6, .max = 1000}),
                group("inertia", kRequired,
                      {number("ixx", kRequired, kNotNegative), number("iyy", kRequired, kNotNegative),
                       number("izz", kRequired, kNotNegative), number("ixy", kOptional),
                       number("ixz", kOptional), number("iyz", kOptional)})});
}

XmlRule box() {
  return group("box", kOptional,
               {{.name = "size", .content = kNumbers, .count = kRequired, .numbers = 3, .range = kSize}});
}

XmlRule mesh() {
  return group("mesh", kOptional,
               {text("uri", kRequired),
                {.name = "scale", .content = kNumbers, .numbers = 3, .range = {.min = 1e-6, .max = 1000}}});
}

// Only the diffuse colour is used; the other elements of SDF's materials are accepted.
XmlRule material() {
  XmlRule rule = group("material", kOptional,
                       {{.name = "diffuse", .content = kNumbers, .numbers = 4, .range = kFraction}});
  for (const char* unused : {"ambient", "specular", "emissive", "shininess", "render_order", "lighting",
                             "double_sided", "script", "shader", "pbr"}) {
    rule.children.push_back({.name = unused, .content = kAnything});
  }
  return rule;
}

XmlRule surface() {
  return group(
      "surface", kRequired,
      {group("friction", kRequired,
             {group("ode", kRequired,
                    {number("mu", kRequired, {.min = 0, .max = 10}),
                     number("mu2", kOptional, {.min = 0, .max = 10}),
                     {.name = "fdir1", .content = kNumbers, .numbers = 3, .range = {.min = -1, .max = 1}}})}),
       group("bounce", kOptional,
             {number("restitution_coefficient", kRequired, kFraction),
              number("threshold", kRequired, kNotNegative)}),
       group("contact", kRequired,
             {group("ode", kRequired,
                    {number("soft_cfm", kRequired, kFraction), number("soft_erp", kRequired, kFraction)})}),
       number("koboshi:reference_step_s", kOptional, {.min = 1e-6, .max = 0.1}),
       text("koboshi:material", kOptional)});
}

XmlRule channel(std::string name) {
  return group(
      std::move(name), kRequired,
      {number("noise_density", kRequired, kNotNegative), number("bias", kRequired, kNotNegative),
       number("bias_instability", kOptional, kNotNegative), number("random_walk", kOptional, kNotNegative),
       number("scale_error", kOptional, kShare), number("cross_axis", kOptional, kShare),
       number("bandwidth_Hz", kRequired, {.min = 0.1, .max = 1e5}),
       number("range", kRequired, {.min = 1e-9, .max = 1e9}),
       number("resolution", kRequired, {.min = 1e-12, .max = 1e9}),
       number("delay_s", kRequired, {.min = 0, .max = 1})});
}

XmlRule update_rate() { return number("update_rate", kRequired, {.min = 1, .max = 1e5}); }

XmlRule jitter() { return number("koboshi:jitter_s", kOptional, {.min = 0, .max = 0.5}); }

XmlRule gyro() {
  XmlRule rule = channel("koboshi:gyro");
  rule.children.push_back(number("g_sensitivity", kOptional, {.min = 0, .max = 1}));
  return rule;
}

XmlRule imu() {
  return group("sensor", kRepeated,
               {pose(), update_rate(), jitter(), gyro(), channel("koboshi:accelerometer")},
               {{.name = "name"}, {.name = "type"}});
}

XmlRule force_torque() {
  return group(
      "sensor", kRepeated,
      {fixed_pose(), update_rate(), jitter(),
       group("force_torque", kRequired, {text("frame", kRequired), text("measure_direction", kRequired)}),
       channel("koboshi:force"), channel("koboshi:torque"), number("koboshi:crosstalk", kOptional, kShare)},
      {{.name = "name"}, {.name = "type"}});
}

XmlRule link() {
  return group(
      "link", kRepeated,
      {pose(), inertial(),
       group("collision", kRepeated, {pose(), group("geometry", kRequired, {box()}), surface()},
             {{.name = "name"}}),
       group("visual", kRepeated, {pose(), group("geometry", kRequired, {box(), mesh()}), material()},
             {{.name = "name"}}),
       imu()},
      {{.name = "name"}});
}

XmlRule axis() {
  XmlRule xyz{.name = "xyz",
              .content = kNumbers,
              .count = kRequired,
              .attributes = {{.name = "expressed_in", .required = false}},
              .numbers = 3,
              .range = {.min = -1, .max = 1}};
  return group("axis", kRequired,
               {xyz, group("limit", kRequired,
                           {number("lower", kRequired, {.min = -1000, .max = 1000}),
                            number("upper", kRequired, {.min = -1000, .max = 1000}),
                            number("velocity", kRequired, {.min = 1e-3, .max = 1000})})});
}

XmlRule joint() {
  const XmlRule servo{.name = "koboshi:servo", .count = kRequired, .attributes = {{.name = "type"}}};
  const XmlRule encoder{.name = "koboshi:encoder",
                        .count = kRequired,
                        .attributes = {{"bits", kInteger, true, {.min = 8, .max = 24}},
                                       {"offset_rad", kNumbers, false, {.min = -1, .max = 1}},
                                       {"noise_counts", kNumbers, false, {.min = 0, .max = 1e4}}}};
  const XmlRule drive{.name = "koboshi:drive",
                      .count = kRequired,
                      .attributes = {{"node_id", kInteger, true, {.min = 1, .max = 127}},
                                     {"vendor_id", kInteger, false, kUnsigned32},
                                     {"product_code", kInteger, false, kUnsigned32},
                                     {"serial_number", kInteger, true, kUnsigned32},
                                     {"sign", kInteger, false, {.min = -1, .max = 1}},
                                     {"zero_rad", kNumbers, false, {.min = -3.2, .max = 3.2}}}};
  return group("joint", kRepeated,
               {pose(), text("parent", kRequired), text("child", kRequired), axis(), servo, encoder, drive,
                force_torque()},
               {{.name = "name"}, {.name = "type"}});
}

}  // namespace

const XmlRule& sdf_rule() {
  static const XmlRule rule =
      group("sdf", kOptional,
            {group("model", kRequired, {servo_library(), servo_type(), battery(), link(), joint()},
                   {{.name = "name"}})},
            {{.name = "version"}, {.name = "xmlns:koboshi", .required = false}});
  return rule;
}

const XmlRule& servo_library_rule() {
  static const XmlRule rule =
      group("koboshi:servo_types", kOptional, {servo_type()}, {{.name = "xmlns:koboshi", .required = false}});
  return rule;
}

}  // namespace koboshi::sim
