#pragma once

#include "sim_board/description/description.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// The play between the gears, with rotor and friction, and the output. At an edge of the gap the rotor pushes
// the output and moves with it; within it both move alone. The impact on an edge is inelastic: gears of small
// servos do not ring. Its state is that of the servo: the physics knows the output only.
//
//   within      the joint feels nothing. The rotor turns by itself: J w' = drive - damping w - friction
//   at an edge  the joint feels the servo as without backlash. In the step in which the rotor arrives the
//               joint also gets its momentum, J (w_rotor - w_joint) / h
//   separation  where the last step's torque shows that the servo pulled, which an edge cannot
class Backlash {
 public:
  Backlash(const ServoDescription& servo, double step_s)
      : half_gap_rad_(0.5 * servo.backlash_rad), step_s_(step_s) {}

  // After a physics step, with the shaft's state: what it has done to rotor and gap.
  void observe(const JointState& shaft);
  // Makes of what rotor and output feel together what the output feels in the next step.
  void apply(ServoTorque& torque) {
    if (half_gap_rad_ != 0.0) apply_gap(torque);
  }

  double rotor_speed_rad_per_s() const { return rotor_speed_rad_per_s_; }
  // Torque of the output on the rotor in the last step: none within the gap.
  double external_Nm() const { return external_Nm_; }
  // Where the rotor is ahead of the middle of the gap.
  double lead_rad() const { return lead_rad_; }
  // Whether rotor and output move together.
  bool engaged() const { return half_gap_rad_ == 0.0 || edge_ != 0; }
  // The edge at which the rotor pushes the output: 1 forward, -1 backward, 0 within the gap.
  int edge() const { return edge_; }

 private:
  void apply_gap(ServoTorque& torque);
  void cross_gap(const JointState& shaft);
  void turn_rotor(const ServoTorque& torque);

  double half_gap_rad_;
  double step_s_;
  int edge_ = 0;
  bool arrives_ = false;
  bool started_ = false;
  double lead_rad_ = 0.0;
  double rotor_speed_rad_per_s_ = 0.0;
  double external_Nm_ = 0.0;
  double last_position_rad_ = 0.0;
  double last_speed_rad_per_s_ = 0.0;
};

}  // namespace koboshi::sim_board
