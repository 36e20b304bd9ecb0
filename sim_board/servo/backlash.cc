#include "sim_board/servo/backlash.h"

#include <algorithm>
#include <cmath>

namespace koboshi::sim_board {

void Backlash::observe(const JointState& shaft) {
  if (!started_) {
    started_ = true;
    rotor_speed_rad_per_s_ = shaft.speed_rad_per_s;
    last_position_rad_ = shaft.position_rad;
  }
  if (half_gap_rad_ == 0.0) {
    rotor_speed_rad_per_s_ = shaft.speed_rad_per_s;
    external_Nm_ = -shaft.servo_Nm;
  } else if (edge_ == 0) {
    cross_gap(shaft);
  } else {
    rotor_speed_rad_per_s_ = shaft.speed_rad_per_s;
    external_Nm_ = -shaft.servo_Nm;
    if (edge_ * shaft.servo_Nm < 0.0) edge_ = 0;
  }
  if (edge_ == 0 && half_gap_rad_ > 0.0) external_Nm_ = 0.0;
  last_position_rad_ = shaft.position_rad;
  last_speed_rad_per_s_ = shaft.speed_rad_per_s;
}

void Backlash::cross_gap(const JointState& shaft) {
  lead_rad_ += step_s_ * rotor_speed_rad_per_s_ - (shaft.position_rad - last_position_rad_);
  const int edge = lead_rad_ > 0.0 ? 1 : -1;
  const bool closes = edge * (rotor_speed_rad_per_s_ - shaft.speed_rad_per_s) > 0.0;
  if (std::abs(lead_rad_) < half_gap_rad_ || !closes) return;
  lead_rad_ = edge * half_gap_rad_;
  edge_ = edge;
  arrives_ = true;
}

void Backlash::apply_gap(ServoTorque& torque) {
  if (edge_ == 0) {
    turn_rotor(torque);
    torque = {};
  } else if (arrives_) {
    torque.drive_Nm +=
        torque.rotor_inertia_kg_m2 / step_s_ * (rotor_speed_rad_per_s_ - last_speed_rad_per_s_);
    arrives_ = false;
  }
}

// Implicit in the speed, as the solver is, and exact in the friction, which stops but never turns round.
void Backlash::turn_rotor(const ServoTorque& torque) {
  const double inertial_Nm_s = torque.rotor_inertia_kg_m2 / step_s_;
  const double resistance_Nm_s = inertial_Nm_s + torque.damping_Nm_s;
  const double drive_Nm = inertial_Nm_s * rotor_speed_rad_per_s_ + torque.drive_Nm;
  const double rest_Nm = std::max(0.0, std::abs(drive_Nm) - torque.friction_Nm);
  rotor_speed_rad_per_s_ = std::copysign(rest_Nm, drive_Nm) / resistance_Nm_s;
}

}  // namespace koboshi::sim_board
