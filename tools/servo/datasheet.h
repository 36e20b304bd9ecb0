#pragma once

#include <string>

namespace koboshi::tools {

// What a servo's data sheet says, and what it does not say and is assumed.
struct Datasheet {
  std::string name = "servo";
  double stall_torque_Nm = 0.0;
  double no_load_speed_rad_per_s = 0.0;
  double voltage_V = 0.0;  // at which both are meant
  double ratio = 0.0;      // turns of the rotor a turn of the output
  // Dry friction and, at no-load speed, viscous friction, of the stall torque. 2 % each: KRS-2552 and MX-64
  // as identified; 10 % and more in small or cheap gears (XL-320, STS3215).
  double dry_friction_share = 0.02;
  double viscous_friction_share = 0.02;
  // J R / kt^2. 12 ms in MX-64 and MX-106, 6 in a KRS-2552, 40 to 46 in XL-320 and STS3215
  // (robots/servos/bam.xml).
  double time_constant_s = 0.012;
  double full_voltage_error_rad = 0.12;
};

// A library of one koboshi:servo_type that stalls and turns as the sheet says, its assumptions as comments:
// at stall kt V / R - Kc = stall torque; at no load kt (V - kt w) / R = Kc + Kv w. Throws sim::InputError
// where that gives no servo of a size that a robot file may have.
std::string servo_type_from(const Datasheet& sheet);

}  // namespace koboshi::tools
