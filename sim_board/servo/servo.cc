#include "sim_board/servo/servo.h"

namespace koboshi::sim {

Servo::Servo(const JointDescription& joint)
    : sign_(joint.drive.sign),
      zero_rad_(joint.drive.zero_rad),
      encoder_(joint.encoder),
      controller_(joint.servo),
      limit_(joint.servo),
      motor_(joint.servo),
      viscous_friction_(joint.servo),
      dry_friction_(joint.servo),
      rotor_(joint.servo) {}

void Servo::sense(const JointState& joint) {
  const std::int32_t position =
      encoder_.position_units(encoder_.read_counts(sign_ * joint.position_rad + zero_rad_));
  previous_units_ = sensed_ ? position_units_ : position;  // the first sample shows no speed
  position_units_ = position;
  sensed_ = true;
  current_A_ = driven_ ? motor_.current_A(voltage_V_, sign_ * joint.speed_rad_per_s) : 0.0;
}

ServoTorque Servo::drive(std::int32_t target_units) {
  driven_ = true;
  voltage_V_ = limit_.limit_V(controller_.voltage_V(target_units, position_units_, previous_units_));
  ServoTorque torque = mechanics();
  motor_.apply(voltage_V_, torque);
  torque.drive_Nm *= sign_;
  return torque;
}

ServoTorque Servo::release() {
  driven_ = false;
  return mechanics();
}

ServoTorque Servo::mechanics() const {
  ServoTorque torque;
  viscous_friction_.apply(torque);
  dry_friction_.apply(torque);
  rotor_.apply(torque);
  return torque;
}

}  // namespace koboshi::sim
