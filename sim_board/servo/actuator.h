#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sim_board/description/description.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// The effects between the duty cycle that a position loop asks for and the output shaft, one in each class.
// Voltages, torques and speeds are those of the shaft. Letters after Rhoban BAM (arXiv 2410.08650).

// The bridge of transistors: it gives at most a part of the supply, less when the winding is hot.
class Bridge {
 public:
  explicit Bridge(const ServoDescription& servo) : max_duty_(servo.max_duty) {}

  // A duty of +-1 is the whole supply.
  double limit(double duty, double share) const {
    const double largest = max_duty_ * share;
    return std::clamp(duty, -largest, largest);
  }

 private:
  double max_duty_;
};

// A DC motor seen at the output shaft: current i = (V - kt w) / R, torque kt i. Its inductance is left out:
// the electrical time constant of a small motor is a tenth of a millisecond.
class Motor {
 public:
  explicit Motor(const ServoDescription& servo)
      : torque_constant_Nm_per_A_(servo.torque_constant_Nm_per_A), resistance_ohm_(servo.resistance_ohm) {}

  // As the winding warms.
  void set_resistance(double resistance_ohm) { resistance_ohm_ = resistance_ohm; }
  double resistance_ohm() const { return resistance_ohm_; }

  void apply(double voltage_V, ServoTorque& torque) const {
    torque.drive_Nm += torque_constant_Nm_per_A_ * voltage_V / resistance_ohm_;
    torque.damping_Nm_s += torque_constant_Nm_per_A_ * torque_constant_Nm_per_A_ / resistance_ohm_;
  }
  double generated_V(double speed_rad_per_s) const { return torque_constant_Nm_per_A_ * speed_rad_per_s; }
  double current_A(double voltage_V, double speed_rad_per_s) const {
    return (voltage_V - generated_V(speed_rad_per_s)) / resistance_ohm_;
  }
  double torque_Nm(double current_A) const { return torque_constant_Nm_per_A_ * current_A; }

 private:
  double torque_constant_Nm_per_A_;
  double resistance_ohm_;
};

// The drive holds the current down by its voltage, to protect itself and to keep the torque limit that it was
// given: |V - kt w| <= R i_max. Behind a limit of the torque itself the back EMF would be lost, and with it
// what keeps the solver stable.
class CurrentLimit {
 public:
  explicit CurrentLimit(const ServoDescription& servo)
      : own_limit_A_(servo.current_limit_A),
        stall_A_(servo.supply_V / servo.resistance_ohm),
        limit_A_(own_limit_A_) {}

  // In 0.001 of the stall torque at nominal supply; 1000: none but the drive's own, so that a motor that is
  // turned from outside still brakes with more than its stall torque.
  void set_torque_limit(std::uint16_t limit_permille) {
    limit_A_ =
        limit_permille >= 1000 ? own_limit_A_ : std::min(own_limit_A_, stall_A_ * limit_permille / 1000);
  }

  double limit_V(double voltage_V, const Motor& motor, double speed_rad_per_s) const {
    const double middle_V = motor.generated_V(speed_rad_per_s);
    const double span_V = motor.resistance_ohm() * limit_A_;
    return std::clamp(voltage_V, middle_V - span_V, middle_V + span_V);
  }

 private:
  double own_limit_A_;
  double stall_A_;
  double limit_A_;
};

// Kv: grease and bearings.
class ViscousFriction {
 public:
  explicit ViscousFriction(const ServoDescription& servo) : coefficient_Nm_s_(servo.viscous_friction_Nm_s) {}

  void apply(ServoTorque& torque) const { torque.damping_Nm_s += coefficient_Nm_s_; }

 private:
  double coefficient_Nm_s_;
};

// The rotor, geared: its inertia at the output exceeds that of most links.
class Rotor {
 public:
  explicit Rotor(const ServoDescription& servo) : inertia_kg_m2_(servo.rotor_inertia_kg_m2) {}

  void apply(ServoTorque& torque) const { torque.rotor_inertia_kg_m2 += inertia_kg_m2_; }

 private:
  double inertia_kg_m2_;
};

}  // namespace koboshi::sim_board
