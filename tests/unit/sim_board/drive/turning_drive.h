#pragma once

#include <algorithm>
#include <cmath>

#include "tests/unit/sim_board/drive/drive_bench.h"

namespace koboshi::sim_board {

// A drive whose shaft turns by the torque of its servo, with a load of the rotor's own inertia.
class TurningDrive : public DriveTest {
 protected:
  void turn_ms(int duration_ms) {
    for (int i = 0; i < duration_ms; ++i) {
      run_ms(1);
      turn(0.001);
    }
  }
  std::int32_t position() const {
    return static_cast<std::int32_t>(std::lround(shaft.position_rad / kRadPerPositionUnit));
  }
  double speed_units_per_s() const { return shaft.speed_rad_per_s / kRadPerPositionUnit; }
  bool limited() const { return (drive->values().statusword & cia402::kInternalLimit) != 0; }
  void place(std::int32_t position) {
    shaft = {.position_rad = position * kRadPerPositionUnit};
    turn_ms(20);
  }
  // By an NMT command; the shaft stays where it is.
  void reset_node() {
    heartbeats = syncs = false;
    controlword = 0;
    target = 0;
    say({.identifier = 0x000, .size = 2, .data = {0x81, kNode}});
    turn_ms(20);
  }
  void write_limits(std::int32_t lowest, std::int32_t highest) {
    write({0x607D, 1}, static_cast<std::uint32_t>(lowest), 4);
    write({0x607D, 2}, static_cast<std::uint32_t>(highest), 4);
  }

 private:
  void turn(double step_s) {
    const double inertia = torque.rotor_inertia_kg_m2 + joint.servo.rotor_inertia_kg_m2;
    const double resistance = inertia + step_s * torque.damping_Nm_s;
    const double free = (inertia * shaft.speed_rad_per_s + step_s * torque.drive_Nm) / resistance;
    const double loss = step_s * torque.friction_Nm / resistance;
    shaft.speed_rad_per_s = std::copysign(std::max(std::abs(free) - loss, 0.0), free);
    shaft.position_rad += step_s * shaft.speed_rad_per_s;
  }
};

}  // namespace koboshi::sim_board
