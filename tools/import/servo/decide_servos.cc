#include "tools/import/servo/decide_servos.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/text/text.h"
#include "tools/import/normalise/repair_links.h"

namespace koboshi::tools {
namespace {

// The servos of usual robots by mass: a KHR-3HV has 1.5 kg, a DARwIn-OP 2.9 kg, kid-size robots up to 8 kg.
std::string usual_servo(const ImportedRobot& robot) {
  double mass_kg = 0.0;
  for (const ImportedLink& link : robot.links) mass_kg += link.mass_kg;
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
  if (joint.reduction != 1.0)
    report.warnings.push_back(fmt::format(
        "{}: its transmission of {:.4g} : 1 is not applied, as servo types are those of the output shaft",
        joint.name, joint.reduction));
}

}  // namespace

void decide_servos(ImportedRobot& robot, const ServoCatalogue& catalogue, Interview& interview,
                   ImportReport& report) {
  const std::string usual =
      interview.answer({"servo", "Which servo moves the joints? (koboshi servo plot shows them)",
                        usual_servo(robot), catalogue.names()});
  for (ImportedJoint& joint : robot.joints) {
    const auto given = interview.given().servos.find(joint.name);
    const std::string& type = given == interview.given().servos.end() ? usual : given->second;
    if (type != usual) interview.taken.servos[joint.name] = type;
    apply(joint, catalogue.find(type, robot.file).servo, interview, report);
  }
}

}  // namespace koboshi::tools
