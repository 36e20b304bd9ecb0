#pragma once

#include <algorithm>

#include "sim_board/robot/description.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// What stands between a voltage and the output shaft, one effect a class. Each adds its part to what the
// solver is asked. Model and letters after Rhoban BAM (arXiv 2410.08650), friction model M1.

// Full PWM is the supply, and no more.
class VoltageLimit {
 public:
  explicit VoltageLimit(const ServoDescription& servo) : supply_V_(servo.supply_V) {}

  double limit_V(double voltage_V) const { return std::clamp(voltage_V, -supply_V_, supply_V_); }

 private:
  double supply_V_;
};

// A DC motor seen at the output shaft: current i = (V - kt w) / R, torque kt i. Its inductance is left out:
// the electrical time constant of a small motor is a tenth of a millisecond.
class Motor {
 public:
  explicit Motor(const ServoDescription& servo)
      : torque_constant_Nm_per_A_(servo.torque_constant_Nm_per_A), resistance_ohm_(servo.resistance_ohm) {}

  void apply(double voltage_V, ServoTorque& torque) const {
    torque.drive_Nm += torque_constant_Nm_per_A_ * voltage_V / resistance_ohm_;
    torque.damping_Nm_s += torque_constant_Nm_per_A_ * torque_constant_Nm_per_A_ / resistance_ohm_;
  }
  double current_A(double voltage_V, double speed_rad_per_s) const {
    return (voltage_V - torque_constant_Nm_per_A_ * speed_rad_per_s) / resistance_ohm_;
  }
  double torque_Nm(double current_A) const { return torque_constant_Nm_per_A_ * current_A; }

 private:
  double torque_constant_Nm_per_A_;
  double resistance_ohm_;
};

// Kv: grease and bearings.
class ViscousFriction {
 public:
  explicit ViscousFriction(const ServoDescription& servo) : coefficient_Nm_s_(servo.viscous_friction_Nm_s) {}

  void apply(ServoTorque& torque) const { torque.damping_Nm_s += coefficient_Nm_s_; }

 private:
  double coefficient_Nm_s_;
};

// Kc: bounds the torque that stops the joint, and holds it while it stands.
class DryFriction {
 public:
  explicit DryFriction(const ServoDescription& servo) : bound_Nm_(servo.coulomb_friction_Nm) {}

  void apply(ServoTorque& torque) const { torque.friction_Nm += bound_Nm_; }

 private:
  double bound_Nm_;
};

// The rotor, geared: its inertia at the output exceeds that of most links.
class Rotor {
 public:
  explicit Rotor(const ServoDescription& servo) : inertia_kg_m2_(servo.rotor_inertia_kg_m2) {}

  void apply(ServoTorque& torque) const { torque.rotor_inertia_kg_m2 += inertia_kg_m2_; }

 private:
  double inertia_kg_m2_;
};

}  // namespace koboshi::sim
