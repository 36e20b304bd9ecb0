#include "sim_board/description/fault_list.h"
#include "sim_board/description/load_parts.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "sim_board/description/servo_types.h"

namespace koboshi::sim_board {
namespace {

LoadShares load_shares(const XmlNode& servo_node, const std::string& name, const std::string& unit) {
  const auto node = servo_node.find(name);
  if (!node) return {};
  return {.motor = node->attribute_number("motor" + unit, 0.0),
          .external = node->attribute_number("external" + unit, 0.0)};
}

StribeckDescription load_stribeck(const XmlNode& servo_node) {
  StribeckDescription stribeck;
  if (const auto node = servo_node.find("stribeck")) {
    stribeck.friction_Nm = node->attribute_number("friction_Nm", 0.0);
    stribeck.speed_rad_per_s = node->attribute_number("speed_rad_per_s", 0.0);
    stribeck.exponent = node->attribute_number("exponent", 0.0);
  }
  return stribeck;
}

std::optional<WindingDescription> load_winding(const XmlNode& servo_node) {
  const auto node = servo_node.find("winding");
  if (!node) return std::nullopt;
  WindingDescription winding;
  winding.thermal_resistance_K_per_W = node->attribute_number("thermal_resistance_K_per_W", 0.0);
  winding.heat_capacity_J_per_K = node->attribute_number("heat_capacity_J_per_K", 0.0);
  winding.ambient_C = node->attribute_number("ambient_C", winding.ambient_C);
  winding.derating_C = node->attribute_number("derating_C", 0.0);
  winding.shutdown_C = node->attribute_number("shutdown_C", 0.0);
  winding.derated_share = node->attribute_number("derated_share", winding.derated_share);
  winding.copper_per_K = node->attribute_number("copper_per_K", winding.copper_per_K);
  return winding;
}

CommandDescription load_command(const XmlNode& servo_node) {
  CommandDescription command;
  if (const auto node = servo_node.find("command")) {
    command.period_ms = static_cast<int>(node->attribute_integer("period_ms", command.period_ms));
    command.write_delay_ms = static_cast<int>(node->attribute_integer("write_delay_ms", 0));
    command.read_delay_ms = static_cast<int>(node->attribute_integer("read_delay_ms", 0));
    command.dead_band_rad = node->attribute_number("dead_band_rad", 0.0);
  }
  return command;
}

std::optional<ScalarSensorDescription> load_meter(const XmlNode& servo_node, const std::string& name,
                                                  const std::string& unit, const std::string& difference) {
  const auto node = servo_node.find(name);
  if (!node) return std::nullopt;
  ScalarSensorDescription meter;
  meter.lowest = node->attribute_number("lowest_" + unit, 0.0);
  meter.highest = node->attribute_number("highest_" + unit, 0.0);
  meter.resolution = node->attribute_number("resolution_" + difference, 0.0);
  meter.noise = node->attribute_number("noise_" + difference, 0.0);
  meter.offset = node->attribute_number("offset_" + difference, 0.0);
  meter.scale_error = node->attribute_number("scale_error", 0.0);
  meter.sample_period_s = node->attribute_number("sample_period_s", meter.sample_period_s);
  return meter;
}

ServoDescription load_servo(const XmlNode& node) {
  ServoDescription servo{
      .torque_constant_Nm_per_A = node.number("torque_constant_Nm_per_A"),
      .resistance_ohm = node.number("resistance_ohm"),
      .supply_V = node.number("supply_V"),
      .rotor_inertia_kg_m2 = node.number("rotor_inertia_kg_m2"),
      .coulomb_friction_Nm = node.number("coulomb_friction_Nm"),
      .viscous_friction_Nm_s = node.number("viscous_friction_Nm_s"),
      .full_voltage_error_rad = node.number("full_voltage_error_rad"),
      .velocity_gain_V_s_per_rad = node.number("velocity_gain_V_s_per_rad", 0.0),
      .stribeck = load_stribeck(node),
      .load_friction = load_shares(node, "load_friction", ""),
      .stribeck_load_friction = load_shares(node, "stribeck_load_friction", ""),
      .quadratic_load_friction_per_Nm = load_shares(node, "quadratic_load_friction", "_per_Nm"),
      .backlash_rad = node.number("backlash_rad", 0.0),
      .winding = load_winding(node),
      .command = load_command(node),
      .voltmeter = load_meter(node, "voltmeter", "V", "V"),
      .thermometer = load_meter(node, "thermometer", "C", "K")};
  servo.max_duty = node.number("max_duty", servo.max_duty);
  servo.current_limit_A = node.number("current_limit_A", servo.current_limit_A);
  return servo;
}

void add_types(const XmlNode& parent, ServoTypes& types) {
  for (const XmlNode& node : parent.children("koboshi:servo_type")) {
    FaultList faults;
    find_servo_faults(node, faults);
    if (!faults.faults().empty()) throw faults.faults().front().error();
    const std::string name = node.attribute("name");
    if (!types.emplace(name, load_servo(node)).second)
      throw node.error("a second servo type " + one_line(name), "each name once");
  }
}

}  // namespace

const XmlFile& ServoLibraries::open(const std::filesystem::path& file) {
  return files_.try_emplace(file, file, servo_library_rule()).first->second;
}

ServoTypes load_servo_types(const XmlNode& model_node, const std::filesystem::path& folder,
                            ServoLibraries& libraries) {
  ServoTypes types;
  add_types(model_node, types);
  for (const XmlNode& node : model_node.children("koboshi:servo_types")) {
    const std::filesystem::path file = folder / node.attribute("file");
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
      throw node.error("file = " + one_line(node.attribute("file")),
                       "a library of servo types that exists, relative to this file's folder");
    }
    add_types(libraries.open(file).root(), types);
  }
  return types;
}

// The bound of friction in docs/reference/servo.md is that of the servo's shaft, whose torque is the joint's
// divided by the ratio: shares of a torque stay, shares of its square are divided once more.
ServoDescription behind_gear(ServoDescription servo, double ratio) {
  servo.torque_constant_Nm_per_A *= ratio;
  servo.rotor_inertia_kg_m2 *= ratio * ratio;
  servo.coulomb_friction_Nm *= ratio;
  servo.viscous_friction_Nm_s *= ratio * ratio;
  servo.full_voltage_error_rad /= ratio;
  servo.velocity_gain_V_s_per_rad *= ratio;
  servo.stribeck.friction_Nm *= ratio;
  servo.stribeck.speed_rad_per_s /= ratio;
  servo.quadratic_load_friction_per_Nm.motor /= ratio;
  servo.quadratic_load_friction_per_Nm.external /= ratio;
  servo.backlash_rad /= ratio;
  servo.command.dead_band_rad /= ratio;
  return servo;
}

std::string expected_servo_type(const std::string& misspelt, std::span<const std::string> known) {
  const std::string own = known.empty() ? "" : ": " + expected_names(misspelt, known);
  return "the name of a koboshi:servo_type" + own +
         "; <koboshi:servo_types file=\"...\"/> in the model includes those of a library";
}

ServoTypes read_servo_types(const std::filesystem::path& file) {
  if (xml_root_name(file) == servo_library_rule().name) {
    ServoTypes types;
    add_types(XmlFile(file, servo_library_rule()).root(), types);
    return types;
  }
  const XmlFile robot(file, sdf_rule());
  ServoLibraries libraries;
  return load_servo_types(robot.root().child("model"), file.parent_path(), libraries);
}

}  // namespace koboshi::sim_board
