#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <memory>

#include "sim_board/engine/ode/library.h"
#include "sim_board/robot/description.h"
#include "sim_board/state/archive.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// The servo and the stops of one hinge inside the constraint solver. ODE solves each row as J v_new = vel -
// CFM lambda, with lambda in N m bounded by +-FMax. Angular motors carry such rows:
//   drive     the torque a - b w_new: vel = a/b, CFM = 1/b, no bound. The rotor's inertia J is in it, J/h
//             w_old in a and J/h in b, and so is sliding friction, -direction Kc in a.
//   friction  while the joint may stick: vel = 0. See Friction.
//   stop      the joint's limits as a spring and damper, in a motor of their own: what the servo gave stays
//             apart from what the stop took.
//
// The rows' direction comes from outside, since the hinge may be one of several between the same two bodies:
// the vector b with b . w = speed of the hinge, w the angular velocity of child against parent. For a hinge
// by itself it is the axis. ODE makes unit vectors of what it is given, so everything else is scaled by |b|.
class ServoMotor {
 public:
  ServoMotor(dWorldID world, const JointDescription& joint, dBodyID child, dBodyID parent, double start_rad,
             double step_s);

  void set_servo(const ServoTorque& torque) { servo_ = torque; }
  const ServoTorque& servo() const { return servo_; }

  // One step is: begin_step, then guess_friction or bound_friction, the solver, set_position and set_speed.
  // After a guess the solver's answer must be confirmed; one that is not calls for another solution from the
  // same state, with the guess corrected.
  // Speed after the step is b . w_new + drift, the drift being what b's own turning adds within the step.
  void begin_step(const Eigen::Vector3d& b_W, double drift_rad_per_s);
  // Takes friction as known: the joint slides one way, or is locked by a single unbounded row. Cheap for the
  // solver.
  void guess_friction() { write_rows(); }
  // Leaves it to the solver: a row bounded by Kc. Always right, and dear.
  void bound_friction();
  // Whether the solution obeys Coulomb: a locked joint held by less than Kc, a slow slider that did not turn
  // round. `w_W` is the solution's angular velocity of child against parent.
  bool friction_is_right(const Eigen::Vector3d& w_W) const;
  // After a solution that does not obey: the other guess; after a second one, soon, the solver's decision.
  void correct_friction();
  // Where the hinge is after the step, but for whole turns.
  void set_position(double position_rad);
  void set_speed(double speed_rad_per_s) { state_.speed_rad_per_s = speed_rad_per_s; }

  const JointState& state() const { return state_; }
  // What servo and stop gave the parent in the last step; they exert no force.
  Eigen::Vector3d on_parent_Nm() const;

  // The rows of ODE's motors are written anew in each step.
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
    kSliding,   // fast enough to slide on in its direction, whatever happens in this step
    kCreeping,  // slow, and guessed to slide
    kLocked,    // slow, and guessed to stick
    kBounded    // slow, and the solver decides
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
  std::unique_ptr<Feedbacks> feedbacks_;  // ODE writes into it, so it never moves
  ServoTorque servo_;
  JointState state_;
  Friction friction_ = Friction::kLocked;
  int doubted_steps_ = 0;
  double direction_ = 0.0;                          // of sliding or creeping
  Eigen::Vector3d b_W_ = Eigen::Vector3d::UnitZ();  // when the step began
  double drift_rad_per_s_ = 0.0;
  double scale_ = 1.0;  // its length
};

}  // namespace koboshi::sim
