#include "sim_board/servo/servo.h"

namespace koboshi::sim_board {

Servo::Servo(const JointDescription& joint, const ServoOptions& options)
    : sign_(joint.drive.sign),
      zero_rad_(joint.drive.zero_rad),
      encoder_(joint.encoder, options.seed, options.noise_scale, joint.name + ".encoder"),
      read_delay_(joint.servo.command.read_delay_ms),
      command_period_(joint.servo.command.period_ms),
      write_delay_(joint.servo.command.write_delay_ms),
      dead_band_(joint.servo.command.dead_band_rad),
      controller_(joint.servo),
      bridge_(joint.servo),
      current_limit_(joint.servo),
      motor_(joint.servo),
      winding_(joint.servo, options.step_s),
      viscous_friction_(joint.servo),
      dry_friction_(joint.servo),
      rotor_(joint.servo),
      backlash_(joint.servo, options.step_s),
      supply_V_(joint.servo.supply_V) {}

// --- Electronics

void Servo::sense(const JointState& joint) {
  const JointState shaft = shaft_of(joint);
  const std::int32_t position =
      encoder_broken_ ? position_units_ : encoder_.position_units(encoder_.read_counts(shaft.position_rad));
  previous_units_ = sensed_ ? position_units_ : position;  // the first sample shows no speed
  position_units_ = position;
  reported_units_ = read_delay_.shift(position);
  sensed_ = true;
  const double speed_rad_per_s =
      backlash_.engaged() ? shaft.speed_rad_per_s : backlash_.rotor_speed_rad_per_s();
  current_A_ = flowing_ ? motor_.current_A(voltage_V_, speed_rad_per_s) : 0.0;
}

void Servo::drive(std::int32_t target_units) {
  driven_ = true;
  const std::int32_t target = write_delay_.shift(command_period_.sample(target_units));
  asked_duty_ =
      controller_.duty(dead_band_.target(target, position_units_), position_units_, previous_units_);
}

void Servo::release() {
  driven_ = false;
  command_period_.restart();
  write_delay_.restart();
}

// --- Motor and gears

SupplyLoad Servo::draw(const JointState& joint) {
  backlash_.observe(shaft_of(joint));
  const double speed_rad_per_s = backlash_.rotor_speed_rad_per_s();
  winding_.heat(flowing_ ? motor_.current_A(voltage_V_, speed_rad_per_s) : 0.0);
  motor_.set_resistance(winding_.resistance_ohm());
  flowing_ = driven_;
  if (!driven_) return {};
  const double wanted_V = bridge_.limit(asked_duty_, winding_.voltage_share()) * supply_V_;
  const double voltage_V = current_limit_.limit_V(wanted_V, motor_, speed_rad_per_s);
  duty_ = bridge_.limit(supply_V_ > 0.0 ? voltage_V / supply_V_ : 0.0, 1.0);
  return {.conductance_S = duty_ * duty_ / motor_.resistance_ohm(),
          .generated_A = duty_ * motor_.generated_V(speed_rad_per_s) / motor_.resistance_ohm()};
}

ServoTorque Servo::torque(double supply_V) {
  supply_V_ = supply_V;
  const double speed_rad_per_s = backlash_.rotor_speed_rad_per_s();
  ServoTorque torque;
  double motor_Nm = 0.0;
  if (driven_) {
    voltage_V_ = duty_ * supply_V;
    motor_.apply(voltage_V_, torque);
    motor_Nm = motor_.torque_Nm(motor_.current_A(voltage_V_, speed_rad_per_s));
  }
  viscous_friction_.apply(torque);
  dry_friction_.apply(motor_Nm, backlash_.external_Nm(), speed_rad_per_s, torque);
  rotor_.apply(torque);
  backlash_.apply(torque);
  torque.drive_Nm *= sign_;
  return torque;
}

}  // namespace koboshi::sim_board
