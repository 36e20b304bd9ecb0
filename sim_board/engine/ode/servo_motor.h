#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <memory>

#include "sim_board/engine/ode/library.h"
#include "sim_board/robot/description.h"
#include "sim_board/state/archive.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// Servo and stops of one hinge as rows of the constraint solver. ODE solves each row as J v_new = vel - CFM
// lambda, with lambda in N m bounded by +-FMax. Angular motors provide these rows:
//   drive     the torque a - b w_new: vel = a/b, CFM = 1/b, unbounded. It includes the rotor inertia J, as
//             J/h w_old in a and J/h in b, and sliding friction, as -direction Kc in a.
//   friction  while the joint may stick: vel = 0. See Friction.
//   stop      the joint's limits as a spring and damper, in a separate motor, so that the torques of servo
//             and stop remain distinguishable.
//
// The caller gives the rows' direction, since the hinge may be one of several between the same two bodies:
// the vector b with b . w = speed of the hinge, where w is the angular velocity of the child relative to the
// parent. For a single hinge it is the axis. ODE normalises vectors, so all other values are scaled by |b|.
class ServoMotor {
 public:
  ServoMotor(dWorldID world, const JointDescription& joint, dBodyID child, dBodyID parent, double start_rad,
             double step_s);

  void set_servo(const ServoTorque& torque) { servo_ = torque; }
  const ServoTorque& servo() const { return servo_; }

  // Sequence of a step: begin_step, then guess_friction or bound_friction, the solver, set_position and
  // set_speed. After a guess, the solution must be confirmed; if it is rejected, the guess is corrected and
  // the step is solved again from the same state. The speed after the step is b . w_new + drift, where the
  // drift is the contribution of b's own rotation.
  void begin_step(const Eigen::Vector3d& b_W, double drift_rad_per_s);
  // Treats friction as known: the joint slides in one direction, or one unbounded row locks it. Cheap to
  // solve.
  void guess_friction() { write_rows(); }
  // Adds a row bounded by Kc. Always correct, but expensive to solve.
  void bound_friction();
  // Returns whether the solution satisfies Coulomb's law: a locked joint is held by less than Kc, and a slow
  // sliding joint has not reversed. `w_W` is the solution's angular velocity of the child relative to the
  // parent.
  bool friction_is_right(const Eigen::Vector3d& w_W) const;
  // Call it after a rejected solution: takes the other guess, or after a second rejection within a short
  // time, leaves the decision to the solver.
  void correct_friction();
  // Position of the hinge after the step, modulo whole turns.
  void set_position(double position_rad);
  void set_speed(double speed_rad_per_s) { state_.speed_rad_per_s = speed_rad_per_s; }

  const JointState& state() const { return state_; }
  // Torque of servo and stop on the parent in the last step; they exert no force.
  Eigen::Vector3d on_parent_Nm() const;

  // The rows of ODE's motors are rewritten in each step.
  void archive(StateArchive& archive) {
    archive(*feedbacks_, servo_, state_, friction_, doubted_steps_, direction_, b_W_, drift_rad_per_s_,
            scale_);
  }

 private:
  struct Feedbacks {
    dJointFeedback servo{};
    dJointFeedback stop{};
  };
  enum class Friction {
    kSliding,   // fast enough to keep sliding in its direction throughout this step
    kCreeping,  // slow, assumed to slide
    kLocked,    // slow, assumed to stick
    kBounded    // slow; the solver decides
  };

  void set_direction(const Eigen::Vector3d& b_W);
  void write_rows();
  double servo_Nm() const;
  double friction_Nm(double speed_rad_per_s) const;

  double step_s_;
  double lower_rad_;
  double upper_rad_;
  double stop_force_mixing_;
  OdeJoint motor_;
  OdeJoint stop_;
  std::unique_ptr<Feedbacks> feedbacks_;  // must not move, because ODE writes into it
  ServoTorque servo_;
  JointState state_;
  Friction friction_ = Friction::kLocked;
  int doubted_steps_ = 0;
  double direction_ = 0.0;                          // of sliding or creeping
  Eigen::Vector3d b_W_ = Eigen::Vector3d::UnitZ();  // at the beginning of the step
  double drift_rad_per_s_ = 0.0;
  double scale_ = 1.0;  // length of b_W_
};

}  // namespace koboshi::sim
