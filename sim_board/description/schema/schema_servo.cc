// The keys of a servo type: motor, friction, position loop, heat, timing, meters.

#include "sim_board/description/schema/schema_rules.h"

namespace koboshi::sim_board {
namespace {

using enum XmlContent;
using enum XmlCount;

XmlRule stribeck() {
  return attributes_rule(
      "stribeck", kOptional,
      {.meaning = "friction that decreases with speed, from model M2 on", .source = kFrictionPaper},
      {number_attribute("friction_Nm", true, {.min = 0, .max = 100},
                        {"N m", "", "Kcs, additional friction at rest", kFrictionPaper}),
       number_attribute("speed_rad_per_s", true, {.min = 1e-3, .max = 1000},
                        {"rad/s", "", "ws, speed at which the effect has decreased to 1/e", kFrictionPaper}),
       number_attribute("exponent", true, {.min = 0.1, .max = 20},
                        {"1", "", "exponent a of the speed's ratio to ws", kFrictionPaper})});
}

// `unit`: suffix of the attributes.
XmlRule load_shares(std::string name, const std::string& suffix, const std::string& unit, NumberRange range,
                    std::string meaning, const std::string& symbol) {
  return attributes_rule(
      std::move(name), kOptional, {.meaning = std::move(meaning), .source = kFrictionPaper},
      {number_attribute(
           "motor" + suffix, true, range,
           {unit, "", "K" + symbol.substr(0, symbol.find(' ')) + ", coefficient of the motor's torque",
            kFrictionPaper}),
       number_attribute(
           "external" + suffix, true, range,
           {unit, "", "K" + symbol.substr(symbol.find(' ') + 1) + ", coefficient of the load's torque",
            kFrictionPaper})});
}

XmlRule winding() {
  constexpr NumberRange kTemperature_C{.min = -50, .max = 300};
  return attributes_rule(
      "winding", kOptional,
      {.meaning = "heat of the winding; without it, the resistance does not depend on the temperature",
       .source = kServoPage},
      {number_attribute("thermal_resistance_K_per_W", true, {.min = 0.01, .max = 1000},
                        {"K/W", "", "thermal resistance from winding to air", kServoPage}),
       number_attribute("heat_capacity_J_per_K", true, {.min = 0.01, .max = 1e4},
                        {"J/K", "", "heat capacity of the winding", kServoPage}),
       number_attribute("ambient_C", false, kTemperature_C,
                        {"deg C", "25",
                         "temperature of the air and initial temperature of the winding, at which "
                         "resistance_ohm holds; below derating_C",
                         kServoPage}),
       number_attribute(
           "derating_C", true, kTemperature_C,
           {"deg C", "", "temperature above which the drive reduces its voltage; below shutdown_C",
            kServoPage}),
       number_attribute("shutdown_C", true, kTemperature_C,
                        {"deg C", "", "temperature at which the drive changes to fault", kServoPage}),
       number_attribute("derated_share", false, kFractionRange,
                        {"1", "0.5", "share of the voltage that is left at shutdown_C", kServoPage}),
       number_attribute("copper_per_K", false, {.min = 0, .max = 0.01},
                        {"1/K", "0.00393", "temperature coefficient of the resistance", kServoPage})});
}

XmlRule command() {
  constexpr NumberRange kDelay_ms{.min = 0, .max = 100};
  return attributes_rule(
      "command", kOptional, {.meaning = "timing of targets and positions", .source = kServoPage},
      {integer_attribute("period_ms", false, {.min = 1, .max = 100},
                         {"ms", "1", "period at which the servo reads a new target", kServoPage}),
       integer_attribute("write_delay_ms", false, kDelay_ms,
                         {"ms", "0", "delay until a target takes effect", kServoPage}),
       integer_attribute("read_delay_ms", false, kDelay_ms,
                         {"ms", "0", "age of the position on the bus", kServoPage}),
       number_attribute("dead_band_rad", false, {.min = 0, .max = 1},
                        {"rad", "0", "position error up to which the servo does nothing", kServoPage})});
}

// Rule of a scalar sensor; `suffix` is the unit of its values in the names of its attributes, `difference`
// that of offsets and noise; `unit` and `difference_unit` are the same for people.
XmlRule meter(std::string name, const std::string& suffix, const std::string& difference,
              const std::string& unit, std::string meaning) {
  constexpr NumberRange kValue{.min = -1000, .max = 1000};
  constexpr NumberRange kError{.min = 0, .max = 100};
  return attributes_rule(
      std::move(name), kOptional, {.meaning = std::move(meaning), .source = kSensorPage},
      {number_attribute("lowest_" + suffix, true, kValue,
                        {unit, "", "lower end of the range, below the upper one", kSensorPage}),
       number_attribute("highest_" + suffix, true, kValue, {unit, "", "upper end of the range", kSensorPage}),
       number_attribute("resolution_" + difference, true, {.min = 1e-6, .max = 100},
                        {difference, "", "size of a count", kSensorPage}),
       number_attribute("noise_" + difference, false, kError,
                        {difference, "0", "standard deviation of a sample", kSensorPage}),
       number_attribute("offset_" + difference, false, kError,
                        {difference, "0", "largest constant offset; the seed draws it", kSensorPage}),
       number_attribute("scale_error", false, kErrorShareRange,
                        {"1", "0", "largest relative error of the scale; the seed draws it", kSensorPage}),
       number_attribute("sample_period_s", false, {.min = 1e-3, .max = 100},
                        {"s", "0.01", "time from sample to sample", kSensorPage})});
}

std::vector<XmlRule> motor() {
  return {
      number_rule("torque_constant_Nm_per_A", kRequired, {.min = 1e-3, .max = 100},
                  {"N m/A", "", "kt, torque per current, at the output shaft", kServoPage}),
      number_rule("resistance_ohm", kRequired, {.min = 1e-3, .max = 1000},
                  {"ohm", "", "R, resistance of winding and bridge", kServoPage}),
      number_rule("supply_V", kRequired, {.min = 0.1, .max = 1000},
                  {"V", "", "nominal supply, and the actual one if the robot has no battery", kServoPage}),
      number_rule("rotor_inertia_kg_m2", kRequired, {.min = 0, .max = 10},
                  {"kg m^2", "", "J, inertia of rotor and gears, at the output shaft", kServoPage}),
      number_rule("coulomb_friction_Nm", kRequired, {.min = 0, .max = 100},
                  {"N m", "", "Kc, friction that does not depend on speed", kFrictionPaper}),
      number_rule("viscous_friction_Nm_s", kRequired, {.min = 0, .max = 100},
                  {"N m s/rad", "", "Kv, friction in proportion to speed", kFrictionPaper}),
      number_rule("full_voltage_error_rad", kRequired, {.min = 1e-4, .max = 10},
                  {"rad", "", "position error at which the controller applies the full supply", kServoPage}),
      number_rule("velocity_gain_V_s_per_rad", kOptional, {.min = 0, .max = 1000},
                  {"V s/rad", "0", "additional damping by the encoder's speed", kServoPage}),
      number_rule("max_duty", kOptional, {.min = 0.01, .max = 1},
                  {"1", "1", "largest duty cycle of the bridge", kServoPage}),
      number_rule("current_limit_A", kOptional, {.min = 1e-3, .max = 1000},
                  {"A", "", "limit of the motor's current; without it, there is none", kServoPage})};
}

}  // namespace

XmlRule servo_type_rule() {
  // With a share of 1 or more, friction would grow faster than the load that causes it.
  constexpr NumberRange kLoadShare{.min = 0, .max = 0.99};
  std::vector<XmlRule> children = motor();
  for (XmlRule rule :
       {stribeck(),
        load_shares("load_friction", "", "1", kLoadShare,
                    "friction in proportion to the load, from model M3 on", "m e"),
        load_shares("stribeck_load_friction", "", "1", kLoadShare,
                    "the same, decreasing with speed, from model M4 on", "ms es"),
        load_shares("quadratic_load_friction", "_per_Nm", "1/(N m)", {.min = 0, .max = 10},
                    "friction with the square of the load, model M6", "mq eq"),
        number_rule(
            "backlash_rad", kOptional, {.min = 0, .max = 0.5},
            {"rad", "0", "gap between output and rotor, from edge to edge; needs a rotor with inertia",
             kServoPage}),
        winding(), command(),
        meter("voltmeter", "V", "V", "V", "measures the supply; without it, the drive knows it exactly"),
        meter("thermometer", "C", "K", "deg C",
              "measures the winding's temperature; without it, the drive knows it exactly")}) {
    children.push_back(std::move(rule));
  }
  return group_rule(
      "koboshi:servo_type", kRepeated,
      {.meaning = "motor, gears and position loop of a servo, to which joints refer", .source = kServoPage},
      std::move(children),
      {text_attribute("name", true, {.meaning = "name of the type, unique", .source = kServoPage})});
}

}  // namespace koboshi::sim_board
