#include <cmath>
#include <numbers>

#include "base/text/text.h"
#include "sim_board/description/description.h"
#include "sim_board/description/fault_list.h"

namespace koboshi::sim_board {
namespace {

// load_robot() normalises any axis, which would hide a mistyped digit.
void find_axis_faults(const XmlNode& xyz, FaultList& faults) {
  const std::vector<double> values = xyz.numbers();
  const double length = std::hypot(values[0], values[1], values[2]);
  if (std::abs(length - 1.0) <= 1e-4) return;
  faults.add(RobotFaultKind::kAxis, xyz,
             "<xyz> = " + one_line(xyz.text()) + ", of length " + number_text(length), "a unit vector");
}

// The encoder measures one turn: the shaft must stay within it over the joint's whole range. A limit in
// another unit, a fault of its own, says nothing about the range.
void find_range_faults(const XmlNode& joint, FaultList& faults) {
  const XmlNode limit = joint.child("axis").child("limit");
  if (faults.has_fault(limit.child("lower")) || faults.has_fault(limit.child("upper"))) return;
  const double lower_rad = limit.number("lower");
  const double upper_rad = limit.number("upper");
  if (lower_rad >= upper_rad) {
    faults.add(RobotFaultKind::kLimits, limit,
               "lower " + number_text(lower_rad) + " and upper " + number_text(upper_rad),
               "lower below upper");
  }
  const XmlNode drive = joint.child("koboshi:drive");
  const auto sign = static_cast<double>(drive.attribute_integer("sign", DriveDescription().sign));
  const double zero_rad = drive.attribute_number("zero_rad", 0.0);
  for (const double limit_rad : {lower_rad, upper_rad}) {
    const double shaft_rad = sign * limit_rad + zero_rad;
    if (std::abs(shaft_rad) < std::numbers::pi) continue;
    faults.add(RobotFaultKind::kShaft, drive,
               "a shaft at " + number_text(shaft_rad) + " rad where joint " + joint.attribute("name") +
                   " is at " + number_text(limit_rad),
               "less than half a turn to either side", "zero_rad");
    return;
  }
}

}  // namespace

void find_joint_faults(const XmlNode& joint, FaultList& faults) {
  find_axis_faults(joint.child("axis").child("xyz"), faults);
  find_range_faults(joint, faults);
  for (const XmlNode& sensor : joint.children("sensor")) find_sensor_faults(sensor, faults);
}

}  // namespace koboshi::sim_board
