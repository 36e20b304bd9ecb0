#pragma once

#include <cstdint>

#include "sim_board/robot/description.h"
#include "sim_board/servo/actuator.h"
#include "sim_board/servo/encoder.h"
#include "sim_board/servo/position_controller.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// The hardware of one servo: encoder, position loop, voltage limit, motor, friction and rotor, composed in
// this order. Its drive calls `sense`, then either `drive` or `release`, once every
// PositionController::kPeriod_s; the torque returned is for World::set_servo and holds until the next call.
// Positions, currents and torques shown are those of the shaft, which turns by sign * joint angle + zero;
// torques returned are those of the joint.
class Servo {
 public:
  explicit Servo(const JointDescription& joint);

  // Samples encoder and current.
  void sense(const JointState& joint);
  std::int32_t position_units() const {
    return position_units_;
  }  // 2^-20 turn; multiples of an encoder count
  double current_A() const { return current_A_; }
  double torque_Nm() const { return motor_.torque_Nm(current_A_); }  // of the motor, before friction

  // One period of the position loop towards `target_units`.
  ServoTorque drive(std::int32_t target_units);
  // All switches open: no current flows, so no torque and no braking. Friction and the rotor's inertia
  // remain.
  ServoTorque release();

 private:
  ServoTorque mechanics() const;

  int sign_;
  double zero_rad_;
  Encoder encoder_;
  PositionController controller_;
  VoltageLimit limit_;
  Motor motor_;
  ViscousFriction viscous_friction_;
  DryFriction dry_friction_;
  Rotor rotor_;

  bool sensed_ = false;
  bool driven_ = false;
  double voltage_V_ = 0.0;
  double current_A_ = 0.0;
  std::int32_t position_units_ = 0;
  std::int32_t previous_units_ = 0;
};

}  // namespace koboshi::sim
