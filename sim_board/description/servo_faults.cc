#include "base/text/text.h"
#include "sim_board/description/description.h"
#include "sim_board/description/fault_list.h"

namespace koboshi::sim_board {
namespace {

void find_winding_faults(const XmlNode& winding, FaultList& faults) {
  const double ambient_C = winding.attribute_number("ambient_C", WindingDescription().ambient_C);
  const double derating_C = winding.attribute_number("derating_C", 0.0);
  const double shutdown_C = winding.attribute_number("shutdown_C", 0.0);
  if (ambient_C < derating_C && derating_C < shutdown_C) return;
  faults.add(RobotFaultKind::kServoType, winding,
             "ambient_C = " + number_text(ambient_C) + ", derating_C = " + number_text(derating_C) +
                 " and shutdown_C = " + number_text(shutdown_C),
             "each above the one before");
}

void find_meter_faults(const XmlNode& meter, const std::string& unit, FaultList& faults) {
  const double lowest = meter.attribute_number("lowest_" + unit, 0.0);
  const double highest = meter.attribute_number("highest_" + unit, 0.0);
  if (lowest < highest) return;
  faults.add(
      RobotFaultKind::kServoType, meter,
      "lowest_" + unit + " = " + number_text(lowest) + " and highest_" + unit + " = " + number_text(highest),
      "the highest above the lowest");
}

}  // namespace

void find_servo_faults(const XmlNode& servo_type, FaultList& faults) {
  if (const auto winding = servo_type.find("winding")) find_winding_faults(*winding, faults);
  if (const auto meter = servo_type.find("voltmeter")) find_meter_faults(*meter, "V", faults);
  if (const auto meter = servo_type.find("thermometer")) find_meter_faults(*meter, "C", faults);
  const double backlash_rad = servo_type.number("backlash_rad", 0.0);
  if (backlash_rad > 0.0 && servo_type.number("rotor_inertia_kg_m2") == 0.0) {
    faults.add(RobotFaultKind::kServoType, servo_type.child("backlash_rad"),
               "backlash_rad = " + number_text(backlash_rad) + " with rotor_inertia_kg_m2 = 0",
               "a rotor with inertia, which moves within its backlash");
  }
}

}  // namespace koboshi::sim_board
