#pragma once

#include <cstdint>

#include "sim_board/description/description.h"
#include "sim_board/servo/actuator.h"
#include "sim_board/servo/backlash.h"
#include "sim_board/servo/battery.h"
#include "sim_board/servo/command.h"
#include "sim_board/servo/dry_friction.h"
#include "sim_board/servo/encoder.h"
#include "sim_board/servo/position_controller.h"
#include "sim_board/servo/winding.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

struct ServoOptions {
  double step_s = 0.001;     // of the physics
  std::uint64_t seed = 1;    // of the encoder's noise,
  double noise_scale = 1.0;  // and what it is multiplied by
};

// The hardware of one servo, in two rates.
//
// Electronics, once every PositionController::kPeriod_s: `sense`, then `drive` or `release`.
//   encoder, read delay; command period, write delay, dead-band, position loop -> duty cycle
// Motor and gears, before each physics step: `draw`, then `torque`, whose result is for World::set_servo.
//   bridge (maximal duty, derating), current limit, supply -> voltage; motor, viscous friction, dry friction,
//   rotor, backlash -> torque. What the step before has done is looked at first: current, heat, gap.
//
// Positions, currents and torques shown are those of the shaft, which turns by sign * joint angle + zero;
// torques returned are those of the joint.
class Servo {  // Large: one member per state of its physics
 public:
  explicit Servo(const JointDescription& joint, const ServoOptions& options = {});

  // Samples encoder and current.
  void sense(const JointState& joint);
  std::int32_t position_units() const { return position_units_; }  // 2^-20 turn; multiples of a count
  std::int32_t reported_units() const { return reported_units_; }  // what the bus gets to know: older
  // From now on the encoder cannot be read: positions stay what they were.
  void break_encoder() { encoder_broken_ = true; }
  void overheat() { winding_.overheat(); }
  bool encoder_broken() const { return encoder_broken_; }
  double current_A() const { return current_A_; }
  double torque_Nm() const { return motor_.torque_Nm(current_A_); }  // of the motor, before friction
  double supply_V() const { return supply_V_; }
  const Winding& winding() const { return winding_; }
  const Backlash& backlash() const { return backlash_; }

  // Limits the motor's torque to this share of the stall torque at nominal supply, 0.001; 1000: no limit but
  // the supply.
  void limit_torque(std::uint16_t limit_permille) { current_limit_.set_torque_limit(limit_permille); }
  // Multiplies the gain of the position loop, in 0.001; 1000: that of the servo's description.
  void scale_gain(std::uint16_t gain_permille) { controller_.scale_gain(gain_permille); }
  // One period of the position loop towards `target_units`.
  void drive(std::int32_t target_units);
  // All switches open: no current flows, so no torque and no braking. Friction and the rotor's inertia
  // remain.
  void release();

  // The joint as the last step left it. Returns what the motor draws in the next, by the supply's voltage.
  SupplyLoad draw(const JointState& joint);
  ServoTorque torque(double supply_V);

 private:
  JointState shaft_of(const JointState& joint) const {
    return {.position_rad = sign_ * joint.position_rad + zero_rad_,
            .speed_rad_per_s = sign_ * joint.speed_rad_per_s,
            .servo_Nm = sign_ * joint.servo_Nm};
  }

  double sign_;  // 1 or -1
  double zero_rad_;
  Encoder encoder_;
  DelayLine read_delay_;
  CommandPeriod command_period_;
  DelayLine write_delay_;
  DeadBand dead_band_;
  PositionController controller_;
  Bridge bridge_;
  CurrentLimit current_limit_;
  Motor motor_;
  Winding winding_;
  ViscousFriction viscous_friction_;
  DryFriction dry_friction_;
  Rotor rotor_;
  Backlash backlash_;

  bool sensed_ = false;
  bool encoder_broken_ = false;
  bool driven_ = false;
  double asked_duty_ = 0.0;
  double duty_ = 0.0;       // that the bridge makes in this step
  double supply_V_;         // in the last step
  double voltage_V_ = 0.0;  // on the motor in the last step
  bool flowing_ = false;    // whether it was driven then
  double current_A_ = 0.0;
  std::int32_t position_units_ = 0;
  std::int32_t previous_units_ = 0;
  std::int32_t reported_units_ = 0;
};

}  // namespace koboshi::sim_board
