#include "tools/import/servo/decide_servos.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/servo_types.h"
#include "tools/import/normalise/repair_links.h"
#include "tools/import/servo/source_servo.h"
#include "tools/import/servo/stiff_servo.h"

namespace koboshi::tools {
namespace {

// The servos of usual robots by mass: a KHR-3HV has 1.5 kg, a DARwIn-OP 2.9 kg, kid-size robots up to 8 kg.
// Heavier robots have drives of their own.
std::string usual_servo(const ImportedRobot& robot) {
  const double mass_kg = mass_of(robot);
  constexpr double kHeaviest_kg = 9.0;
  if (mass_kg > kHeaviest_kg) return kSourceServo;
  if (mass_kg < 1.7) return "krs_2552";
  if (mass_kg < 4.0) return "mx_28";
  return mass_kg < 5.5 ? "mx_64_m6" : "mx_106_m6";
}

void apply(ImportedJoint& joint, const sim_board::ServoDescription& servo, Interview& interview,
           ImportReport& report) {
  constexpr double kMargin = 1.05;  // data sheets round
  const double stall_Nm = stall_torque_Nm(servo);
  const double speed_rad_per_s = no_load_speed_rad_per_s(servo);
  if (joint.effort_Nm > kMargin * stall_Nm)
    report.normalised.push_back(
        fmt::format("{}: an effort of {:.3g} N m -> {:.3g} N m, because that is what its servo has",
                    joint.name, joint.effort_Nm, stall_Nm));
  if (joint.speed_rad_per_s <= 0.0) {
    joint.speed_rad_per_s = speed_rad_per_s;
  } else if (joint.speed_rad_per_s > kMargin * speed_rad_per_s &&
             take_repair(
                 {.key = joint.name + ".speed",
                  .found = fmt::format("{} with a speed of {:.3g} rad/s", joint.name, joint.speed_rad_per_s),
                  .taken = fmt::format("{:.3g} rad/s", speed_rad_per_s),
                  .because = "that is what its servo has without load"},
                 interview, report)) {
    joint.speed_rad_per_s = speed_rad_per_s;
  }
}

// URDFs give the ratio of the servo's own gearbox, 193 : 1 in an MX-28, as well as that of a belt behind it.
void decide_transmissions(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  constexpr double kMinGear = 0.02;  // of koboshi:servo@gear
  constexpr double kMaxGear = 50.0;
  constexpr double kMaxStage = 10.0;  // belts and pairs of gears behind a servo are below, gearboxes above
  double largest = 1.0;
  for (const ImportedJoint& joint : robot.joints)
    if (!joint.has_stage && std::abs(std::log(joint.reduction)) > std::abs(std::log(largest)))
      largest = joint.reduction;
  const bool is_outside =
      largest != 1.0 &&
      interview.answer(
          {"transmission",
           fmt::format("Where are the transmissions, of up to {:.4g} : 1? inside: in the servo, "
                       "whose catalogue values are those of its output shaft; outside: behind it",
                       largest),
           largest <= kMaxStage ? "outside" : "inside",
           {"inside", "outside"}}) == "outside";
  for (ImportedJoint& joint : robot.joints) {
    if (joint.reduction == 1.0) continue;
    const bool is_stage = is_outside || joint.has_stage;
    report.normalised.push_back(
        fmt::format("{}: a transmission of {:.4g} : 1 {}", joint.name, joint.reduction,
                    is_stage ? "behind the servo" : "in the servo, whose values include it"));
    if (!is_stage) {
      joint.reduction = 1.0;
    } else if (joint.reduction < kMinGear || joint.reduction > kMaxGear) {
      throw InputError(robot.file, joint.line,
                       fmt::format("a transmission of {:.4g} : 1 behind the servo", joint.reduction),
                       fmt::format("a ratio from {} to {}, or transmission: inside", kMinGear, kMaxGear));
    }
  }
}

}  // namespace

void decide_servos(ImportedRobot& robot, ServoCatalogue& catalogue, Interview& interview,
                   ImportReport& report) {
  std::vector<std::string> choices = catalogue.names();
  choices.emplace_back(kSourceServo);
  const std::string usual = interview.answer(
      {"servo",
       "Which servo moves the joints? (koboshi servo plot shows them; source: as strong as the file says)",
       stiff_servo(usual_servo(robot), robot, catalogue), choices});
  SourceServos source_servos(robot, catalogue, report);
  // The source's torques and speeds are those of its joints.
  if (usual != kSourceServo) decide_transmissions(robot, interview, report);
  for (ImportedJoint& joint : robot.joints) {
    if (joint.is_follower) continue;
    const auto given = interview.given().servos.find(joint.name);
    const std::string& type = given == interview.given().servos.end() ? usual : given->second;
    if (type != usual) interview.taken.servos[joint.name] = type;
    if (usual == kSourceServo) joint.reduction = 1.0;
    joint.servo = type == kSourceServo ? source_servos.type_of(joint) : type;
    apply(joint, sim_board::behind_gear(catalogue.find(joint.servo, robot.file).servo, joint.reduction),
          interview, report);
  }
}

}  // namespace koboshi::tools
