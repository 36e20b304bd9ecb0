#include "tools/servo/datasheet.h"

#include <numbers>

#include <fmt/format.h>

#include "base/xml/xml_reader.h"
#include "sim_board/description/schema/sdf_schema.h"

namespace koboshi::tools {
namespace {

constexpr double kRpm = 60.0 / (2.0 * std::numbers::pi);
constexpr double kGramSquareCentimetres = 1e7;

}  // namespace

std::string servo_type_from(const Datasheet& sheet) {
  const double coulomb_Nm = sheet.dry_friction_share * sheet.stall_torque_Nm;
  const double viscous_Nm = sheet.viscous_friction_share * sheet.stall_torque_Nm;
  const double motor_stall_Nm = sheet.stall_torque_Nm + coulomb_Nm;
  const double kt =
      sheet.voltage_V / sheet.no_load_speed_rad_per_s * (sheet.stall_torque_Nm - viscous_Nm) / motor_stall_Nm;
  const double resistance_ohm = kt * sheet.voltage_V / motor_stall_Nm;
  const double inertia_kg_m2 = sheet.time_constant_s * kt * kt / resistance_ohm;

  const std::string text = fmt::format(
      R"(<koboshi:servo_types xmlns:koboshi="https://koboshi.invalid/sdf">
  <!--
    From a data sheet: stall torque {stall:.4g} N m and no-load speed {speed:.4g} rad/s at {voltage:.4g} V, ratio {ratio:.4g}.
    Assumed, for the sheet does not say it:
      dry friction, {dry:.3g} % of the stall torque
      viscous friction, {viscous:.3g} % of the stall torque at no-load speed
      rotor inertia, by a mechanical time constant J R / kt^2 of {time:.3g} ms
      full voltage at {error:.3g} rad of error
      no Stribeck and no load-dependent friction, no backlash, no current limit, no heat
    kt and R follow: both torques above balance the motor's at stall and at no load.
    To compare with what is known of the motor itself: kt {motor_kt:.4g} N m/A, stall current {current:.3g} A, no load {rpm:.4g} rpm,
    rotor {rotor:.3g} g cm^2.
  -->
  <koboshi:servo_type name="{name}">
    <torque_constant_Nm_per_A>{kt:.4g}</torque_constant_Nm_per_A>
    <resistance_ohm>{resistance:.4g}</resistance_ohm>
    <supply_V>{voltage:.4g}</supply_V>
    <rotor_inertia_kg_m2>{inertia:.4g}</rotor_inertia_kg_m2>
    <coulomb_friction_Nm>{coulomb:.4g}</coulomb_friction_Nm>
    <viscous_friction_Nm_s>{kv:.4g}</viscous_friction_Nm_s>
    <full_voltage_error_rad>{error:.4g}</full_voltage_error_rad>
  </koboshi:servo_type>
</koboshi:servo_types>
)",
      fmt::arg("stall", sheet.stall_torque_Nm), fmt::arg("speed", sheet.no_load_speed_rad_per_s),
      fmt::arg("voltage", sheet.voltage_V), fmt::arg("ratio", sheet.ratio),
      fmt::arg("dry", 100.0 * sheet.dry_friction_share),
      fmt::arg("viscous", 100.0 * sheet.viscous_friction_share),
      fmt::arg("time", 1000.0 * sheet.time_constant_s), fmt::arg("error", sheet.full_voltage_error_rad),
      fmt::arg("motor_kt", kt / sheet.ratio), fmt::arg("current", sheet.voltage_V / resistance_ohm),
      fmt::arg("rpm", kRpm * sheet.ratio * sheet.no_load_speed_rad_per_s),
      fmt::arg("rotor", kGramSquareCentimetres * inertia_kg_m2 / (sheet.ratio * sheet.ratio)),
      fmt::arg("name", sheet.name), fmt::arg("kt", kt), fmt::arg("resistance", resistance_ohm),
      fmt::arg("inertia", inertia_kg_m2), fmt::arg("coulomb", coulomb_Nm),
      fmt::arg("kv", viscous_Nm / sheet.no_load_speed_rad_per_s));
  static_cast<void>(
      XmlFile("servo type", text, sim_board::servo_library_rule()));  // what we print, must load
  return text;
}

}  // namespace koboshi::tools
