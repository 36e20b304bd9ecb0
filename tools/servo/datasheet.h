#pragma once

#include <string>

namespace koboshi::tools {

// The values of a servo's data sheet, and assumptions about those that it lacks.
struct Datasheet {
  std::string name = "servo";
  double stall_torque_Nm = 0.0;
  double no_load_speed_rad_per_s = 0.0;
  double voltage_V = 0.0;  // of both values above
  double ratio = 0.0;      // turns of the rotor per turn of the output
  // Dry friction and, at no-load speed, viscous friction, as shares of the stall torque. 2 % each is the
  // identified value of KRS-2552 and MX-64; small or cheap gears (XL-320, STS3215) have 10 % and more.
  double dry_friction_share = 0.02;
  double viscous_friction_share = 0.02;
  // J R / kt^2. 12 ms in MX-64 and MX-106, 6 in a KRS-2552, 40 to 46 in XL-320 and STS3215
  // (robots/servos/bam.xml).
  double time_constant_s = 0.012;
  double full_voltage_error_rad = 0.12;
};

// Makes a library of one koboshi:servo_type with the sheet's stall torque and no-load speed, and its
// assumptions as comments: at stall kt V / R - Kc = stall torque; at no load kt (V - kt w) / R = Kc + Kv w.
// Throws InputError if a value is out of the range of a robot file.
std::string servo_type_from(const Datasheet& sheet);

}  // namespace koboshi::tools
