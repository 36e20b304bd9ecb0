// The keys of the sensors: inertial unit of a link, sensor of a foot.

#include "sim_board/description/schema/schema_rules.h"

namespace koboshi::sim_board {
namespace {

using enum XmlCount;

// `unit`: of the channel's values.
XmlRule channel(std::string name, const std::string& unit, std::string meaning, XmlCount count = kRequired) {
  return group_rule(
      std::move(name), count, {.meaning = std::move(meaning), .source = kSensorPage},
      {number_rule(
           "noise_density", kRequired, kNotNegativeRange,
           {unit + "/sqrt(Hz)", "",
            "white noise, one-sided density: a sample has the standard deviation density * sqrt(rate / 2)",
            kNoiseStandard}),
       number_rule("bias", kRequired, kNotNegativeRange,
                   {unit, "", "largest constant bias; the seed draws it", kSensorPage}),
       number_rule("bias_instability", kOptional, kNotNegativeRange,
                   {unit, "0", "coefficient B of flicker noise; the Allan deviation's flat part is 0.664 B",
                    kNoiseStandard}),
       number_rule("random_walk", kOptional, kNotNegativeRange,
                   {unit + "/sqrt(s)", "0", "coefficient K of the random walk, K sqrt(t) after a time t",
                    kNoiseStandard}),
       number_rule("scale_error", kOptional, kErrorShareRange,
                   {"1", "0", "largest relative error of an axis' scale; the seed draws it", kSensorPage}),
       number_rule(
           "cross_axis", kOptional, kErrorShareRange,
           {"1", "0", "largest share of one axis' signal in another axis; the seed draws it", kSensorPage}),
       number_rule(
           "bandwidth_Hz", kRequired, {.min = 0.1, .max = 1e5},
           {"Hz", "", "-3 dB of the anti-alias filter, a 2nd-order Butterworth low-pass", kSensorPage}),
       number_rule("range", kRequired, {.min = 1e-9, .max = 1e9},
                   {unit, "", "saturation limit in both directions", kSensorPage}),
       number_rule(
           "resolution", kRequired, {.min = 1e-12, .max = 1e9},
           {unit + "/count", "", "size of a count; range / resolution must fit 16 bits", kSensorPage}),
       number_rule("delay_s", kRequired, {.min = 0, .max = 1},
                   {"s", "", "from the nominal sampling instant to the board", kSensorPage})});
}

XmlRule update_rate() {
  return number_rule("update_rate", kRequired, {.min = 1, .max = 1e5},
                     {"Hz", "", "rate of the samples, independent of the physics step", kSdf});
}

XmlRule jitter() {
  return number_rule(
      "koboshi:jitter_s", kOptional, {.min = 0, .max = 0.5},
      {"s", "0", "largest deviation of a sampling instant; less than half the period", kSensorPage});
}

XmlRule gyro() {
  XmlRule rule = channel("koboshi:gyro", "rad/s", "gyroscope, three axes");
  rule.children.push_back(number_rule(
      "g_sensitivity", kOptional, {.min = 0, .max = 1},
      {"rad/s per m/s^2", "0",
       "largest rate error of an axis per specific force of an axis; the seed draws it", kSensorPage}));
  return rule;
}

}  // namespace

XmlRule imu_rule() {
  return group_rule(
      "sensor", kRepeated,
      {.meaning = "the inertial unit: gyroscope and accelerometer; at most one", .source = kSdf},
      {pose_rule("the link's frame"), update_rate(), jitter(), gyro(),
       channel("koboshi:accelerometer", "m/s^2", "accelerometer, three axes")},
      {name_attribute("name of the sensor"),
       text_attribute("type", true, {.meaning = "kind of sensor", .source = kSdf}, {"imu"})});
}

XmlRule ankle_rule() {
  return group_rule(
      "sensor", kRepeated,
      {.meaning =
           "sensor of a foot, on the joint that carries it; one of the same type on each side, or none. "
           "force_torque: six axes between shank and sole, with the three keys force_torque, "
           "koboshi:force and koboshi:torque; koboshi:pressure_cells: four cells in the sole, with "
           "koboshi:cell four times and koboshi:cell_force; koboshi:contact_switch: a switch in the sole, "
           "with koboshi:closing_force_N",
       .source = kSensorPage},
      {fixed_pose_rule("the joint's frame"), update_rate(), jitter(),
       group_rule(
           "force_torque", kOptional, {.meaning = "axes and sign of the wrench", .source = kSdf},
           {text_rule("frame", kRequired, {.meaning = "axes of the wrench", .source = kSdf}, {"sensor"}),
            text_rule("measure_direction", kRequired,
                      {.meaning = "the wrench is that of the ground side on the shank side", .source = kSdf},
                      {"child_to_parent"})}),
       channel("koboshi:force", "N", "force, three axes", kOptional),
       channel("koboshi:torque", "N m", "torque, three axes", kOptional),
       numbers_rule("koboshi:cell", kRepeated, 2, {.min = -1, .max = 1},
                    {"m", "", "x and y of a pressure cell in the sensor's frame", kSensorPage}),
       channel("koboshi:cell_force", "N", "force of a pressure cell; never below zero", kOptional),
       number_rule(
           "koboshi:closing_force_N", kOptional, {.min = 1e-3, .max = 1e3},
           {"N", "", "load of the foot at which the switch closes; it opens at half of it", kSensorPage}),
       number_rule("koboshi:crosstalk", kOptional, kErrorShareRange,
                   {"1", "0",
                    "largest output of a force axis, as a share of its range, for a torque at its range, "
                    "and the reverse; the seed draws it",
                    kSensorPage})},
      {text_attribute("name", true, {.meaning = "side of the sensor", .source = kSensorPage},
                      {"left_ankle", "right_ankle"}),
       text_attribute("type", true, {.meaning = "kind of sensor", .source = kSdf},
                      {kForceTorqueType, kPressureCellsType, kContactSwitchType})});
}

}  // namespace koboshi::sim_board
