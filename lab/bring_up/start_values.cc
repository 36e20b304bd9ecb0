#include "lab/bring_up/start_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "base/text/error.h"
#include "base/text/user_units.h"
#include "lab/bring_up/parameter_values.h"
#include "lab/bring_up/value_fits.h"

namespace koboshi::lab {
namespace {

using simulation::ParameterSetting;
using simulation::RobotParameters;

// Share of a servo's stiffness that is left of it beside the moment by which gravity tips a leaning robot on
// one foot: 1 - m g h / k.
double tipping_margin(const BodyMeasures& body, double stiffness) {
  return 1.0 - body.weight_N * body.com_m / stiffness;
}

// The same as a share of that of the robot from which the values come.
double relative_margin(const BodyMeasures& body, const BodyMeasures& from, double BodyMeasures::*stiffness) {
  return tipping_margin(body, body.*stiffness) / tipping_margin(from, from.*stiffness);
}

// Sag of a knee that is bent by a right angle under the robot's weight, in rad.
double softness(const BodyMeasures& body) {
  return body.weight_N * body.limb_m / body.pitch_stiffness_Nm_per_rad;
}

// Length of bent legs, as a share of straight ones, of a robot whose knees are `softer` times as soft as the
// reference's. Its knees bear a shorter lever, so that they sag by at most twice as much as those of the
// reference.
double straighter(double leg_use, double softer) {
  constexpr double kMostSag = 2.0;
  // By hand, 28 November 2026, for DARwIn-OP with mx_28 servos, 4.2 times as soft: with 0.87 to 0.9 it makes
  // good 0.22 m/s of 0.38, with 0.83 0.16 to 0.21 m/s and with 0.95, whose steps are short, 0.16 m/s.
  constexpr double kStraightest = 0.9;
  if (softer <= kMostSag) return leg_use;
  const double sine = std::sqrt(std::max(0.0, 1.0 - leg_use * leg_use)) * kMostSag / softer;
  return std::max(leg_use, std::min(kStraightest, std::sqrt(1.0 - sine * sine)));
}

// By which power of the ratio of the legs' lengths a parameter grows, by the unit at the end of its key.
double exponent_of(std::string_view key) {
  struct Unit {
    std::string_view end;
    double exponent;
  };
  constexpr std::array<Unit, 12> kUnits{{{"_mm_per_s2", 0.0},
                                         {"_mm_per_s", 0.5},
                                         {"_mrad_per_s2", -1.0},
                                         {"_mrad_per_s", -0.5},
                                         {"_deg_s_per_m", -0.5},
                                         {"_deg_per_s", -0.5},
                                         {"_rad_per_m", -1.0},
                                         {"_deg", 0.0},
                                         {"_percent", 0.0},
                                         {"_mm", 1.0},
                                         {"_ms", 0.5},
                                         {"_s", 0.5}}};
  // Servos and bus answer as late on a larger robot.
  if (key == "plan_age_ms") return 0.0;
  for (const Unit& unit : kUnits) {
    if (key.ends_with(unit.end)) return unit.exponent;
  }
  return 0.0;
}

// By the file of the robot, as firmware/behaviour/supply_guard.h defines them; the guard takes all servos as
// of one kind. Whole steps of the parameters.
void set_supply_load(RobotParameters& parameters, const sim_board::RobotDescription& robot) {
  const sim_board::ServoDescription& servo = robot.joints.front().servo;
  const double resistance_ohm = robot.battery ? robot.battery->internal_resistance_ohm : 0.0;
  const double sag_mV = 1e3 * resistance_ohm * servo.supply_V / servo.resistance_ohm;
  const double speed_deg_per_s = kDegreesPerRad * servo.supply_V / servo.torque_constant_Nm_per_A;
  constexpr double kMaxSpeed_deg_per_s = 2'879.0;  // the range of object 2100:06
  set_value(parameters, "stalled_drive_sag_mV", std::min(std::round(sag_mV), 65'535.0));
  set_value(parameters, "no_load_speed_deg_per_s",
            std::min(std::round(speed_deg_per_s), kMaxSpeed_deg_per_s));
}

// Lets the feedback of the lean at the ankles do what stiffer servos would, for robots that gravity tips
// nearly as strongly as their servos hold them.
void stiffen(RobotParameters& parameters, const BodyMeasures& body, const BodyMeasures& from) {
  // A gain of 65 % for a DARwIn-OP with mx_28 servos, a ratio of 1.4, by hand, 30 November 2026: in worlds
  // `mild` it loses none of 60 at 0.2 m/s and 2 of 60 at 0.5 m/s; with 42 %, 4 of 30 at 0.2 m/s.
  constexpr double kLeastRatio = 2.3;
  const double ratio = body.pitch_stiffness_Nm_per_rad / (body.weight_N * body.com_m);
  if (ratio < kLeastRatio) {
    const double gain_percent = 100.0 * std::min(1.0, kLeastRatio / ratio - 1.0);
    set_value(parameters, "walking_lean_gain_ankle_pitch_percent", gain_percent);
    set_value(parameters, "standing_lean_gain_ankle_pitch_percent", gain_percent);
  }
  const double margin =
      std::clamp(relative_margin(body, from, &BodyMeasures::pitch_stiffness_Nm_per_rad), 0.25, 1.0);
  // Servos that sag let the hip of the swinging leg down, so that its foot leaves the ground late and touches
  // it early. By hand, 30 November 2026, for the same robot, a margin of 0.36, in 30 worlds `mild`: told
  // 0.465 m/s, it loses 4 of 20 with the reference's step height and none of 30 with 1.2 times as much; told
  // 0.5 m/s, none of 30 with 1.36 times as much.
  multiply_value(parameters, "step_height_mm", std::pow(margin, -0.3));
  // They shorten the steps, too: told 0.5 m/s, this robot makes good 0.36.
  multiply_value(parameters, "highest_velocity_forward_mm_per_s", std::pow(margin, -0.57));
}

constexpr double kMostCompliance_rad_per_m = 3.0;  // the range of object 0x2131
// Length of bent legs as a share of the straight ones. Above, knees are within 16 degrees of straight, where
// their torque no longer moves the body; below, thigh and shank of most robots meet. By hand.
constexpr double kMostLegUse = 0.99;
constexpr double kLeastLegUse = 0.6;

}  // namespace

StartValues scaled_values(const RobotParameters& reference, const BodyMeasures& from,
                          const sim_board::RobotDescription& robot, const simulation::NamedModel& model,
                          const StartFactors& factors) {
  const BodyMeasures body = measure(robot);
  const double scale = body.leg_m / from.leg_m;
  StartValues values{.parameters = reference, .robot_file = robot.file, .time_scale = std::sqrt(scale)};
  RobotParameters& parameters = values.parameters;
  parameters.file = robot.file.parent_path() / "parameters.yaml";
  parameters.robot.text = model.robot;
  for (ParameterSetting& setting : parameters.settings) {
    setting.name.source = parameters.file;
    setting.name.line = 0;
    setting.value *= std::pow(scale, exponent_of(setting.name.text));
  }
  for (const char* key : {"lowest_supply_mV", "highest_supply_mV", "low_supply_mV"})
    multiply_value(parameters, key, body.supply_V / from.supply_V);
  set_supply_load(parameters, robot);
  // The plan follows arms and waist; only the reference was tuned without.
  set_value(parameters, "fixed_upper_body", 0.0);
  // Whether its arms are free to turn that far is not known.
  set_value(parameters, "arm_reaction_rad_per_m", 0.0);
  set_value(parameters, "touchdown_load_N", 0.0);
  // Legs that stand far apart walk on a narrower track: the sway of the body from foot to foot grows with its
  // width. 1.14 walks.
  constexpr double kMostStance = 1.2;
  const double stance = std::min(kMostStance, body.stance_m / from.stance_m / scale);
  multiply_value(parameters, "step_width_mm", stance);
  multiply_value(parameters, "widest_step_mm", stance);
  set_value(parameters, "narrowest_step_mm", kMmPerM * body.sole_width_m + 2.0 * scale);
  const double lowered_m = from.com_m - *find_value(reference, "com_height_mm") / kMmPerM;
  const double leg_use = straighter(1.0 - lowered_m / from.limb_m, softness(body) / softness(from));
  set_value(parameters, "com_height_mm",
            kMmPerM * (body.com_m - (1.0 - leg_use) * body.limb_m) * factors.com_height);
  multiply_value(parameters, "step_time_ms", factors.step_time);
  multiply_value(parameters, "pushed_step_time_ms", factors.step_time);
  // The ZMP keeps its place in the sole, which need not be below the ankle.
  set_value(parameters, "zmp_forward_mm",
            kMmPerM * (body.sole_middle_m - scale * from.sole_middle_m) +
                scale * value_or(reference, "zmp_forward_mm", kMmPerM * from.sole_middle_m));
  // A servo sags by torque over stiffness, and the torque is the weight times the lever, which is the
  // parameter's metre. The scaling by length above does not apply. An error of the compensation (of masses or
  // gains, a tenth in the world `mild`) lets the robot lean, and the lean is amplified by 1 / tipping margin.
  // The compensation is reduced by this margin, which keeps the error of the lean: a DARwIn-OP with mx_28
  // servos (margin 0.36) falls with the full compensation, 3 rad/m, and walks with 0.8 to 2.2 rad/m
  // (27 November 2026). The walk that closes its loop steps where the lean wants it, and the compensation in
  // pitch then counts twice and more, so that the margin is cubed: of 0.38 m/s the same robot makes good 0.07
  // m/s with 2.2 rad/m, 0.22 with 1.36 and 0.28 with 0.4; with 0 one of four falls (28 November 2026). Told
  // 0.465 m/s, it loses 6 of 20 with 0.8, 4 of 20 with 0.49 and 3 of 30 with 0.2 (30 November 2026).
  const auto sag = [&](const char* key, double BodyMeasures::*stiffness, double power) {
    const double* tuned = find_value(reference, key);
    if (tuned == nullptr) return;
    const double margin = relative_margin(body, from, stiffness);
    const double compliance = *tuned * (body.weight_N / from.weight_N) /
                              (body.*stiffness / (from.*stiffness)) * std::pow(std::max(0.0, margin), power);
    set_value(parameters, key, std::clamp(compliance, 0.0, kMostCompliance_rad_per_m));
  };
  sag("pitch_compliance_rad_per_m", &BodyMeasures::pitch_stiffness_Nm_per_rad, 3.0);
  sag("roll_compliance_rad_per_m", &BodyMeasures::roll_stiffness_Nm_per_rad, 1.0);
  stiffen(parameters, body, from);
  for (ParameterSetting& setting : parameters.settings) {
    if (setting.name.text.starts_with("walking_")) setting.value *= factors.gains;
  }
  if (double* pitch = find_value(parameters, "trunk_pitch_deg")) *pitch += factors.trunk_pitch_deg;
  try {
    fit_values(parameters, body, model.model);
  } catch (const InputError& error) {
    // The file of the parameters is still to be written.
    throw InputError(robot.file, 0, "a robot whose start values do not fit it: " + error.found(),
                     error.expected(), error.limit());
  }
  set_com_height(values, body, *find_value(parameters, "com_height_mm") / kMmPerM);
  values.step_width_m = *find_value(parameters, "step_width_mm") / kMmPerM;
  values.com_forward_m = body.sole_middle_m;
  values.leg_m = body.leg_m;
  values.sole_width_m = body.sole_width_m;
  if (values.leg_use > kMostLegUse || values.leg_use < kLeastLegUse)
    throw InputError(
        robot.file, 0,
        fmt::format("a CoM height of {:.0f} mm, for which legs of {:.0f} mm would be {:.0f} mm long",
                    kMmPerM * values.com_height_m, kMmPerM * body.limb_m,
                    kMmPerM * values.leg_use * body.limb_m),
        fmt::format("{:.0f} to {:.0f} mm", kMmPerM * (body.com_m - (1 - kLeastLegUse) * body.limb_m),
                    kMmPerM * (body.com_m - (1 - kMostLegUse) * body.limb_m)));
  fit_stance(values, body, model);
  return values;
}

double StartValues::value(const std::string& key) const {
  for (const ParameterSetting& setting : parameters.settings) {
    if (setting.name.text == key) return setting.value;
  }
  return 0.0;
}

std::string parameters_text(const StartValues& values, const std::string& origin) {
  std::string text =
      fmt::format("# {}.\nversion: 1\nrobot: {}\nparameters:\n", origin, values.parameters.robot.text);
  for (const ParameterSetting& setting : values.parameters.settings)
    text += fmt::format("  {}: {:.5g}\n", setting.name.text, setting.value);
  return text;
}

}  // namespace koboshi::lab
