#pragma once

#include <ode/ode.h>

#include <Eigen/Core>

#include "sim_board/engine/ode/library.h"
#include "sim_board/robot/description.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// A hinge with a servo inside the constraint solver. ODE solves each row as J v_new = vel - CFM lambda, with
// lambda in N m bounded by +-FMax. An angular motor with three parallel axes carries such rows:
//   drive     the torque a - b w_new: vel = a/b, CFM = 1/b, no bound. The rotor's inertia J is in it, J/h
//   w_old in a and
//             J/h in b, and so is sliding friction, -direction Kc in a.
//   friction  while the joint may stick: vel = 0. See Friction.
//   stop      the joint's limits as a spring and damper. Never on the axis of the drive: ODE applies a
//   powered axis'
//             bound as a torque at its stop.
class ServoJoint {
 public:
  // The bodies must stand as at joint zero, with the model frame in the world's. `start_rad` is where the
  // caller moves them.
  ServoJoint(dWorldID world, const JointDescription& joint, dBodyID child, dBodyID parent, double start_rad,
             double step_s);

  void set_servo(const ServoTorque& torque) { servo_ = torque; }
  const ServoTorque& servo() const { return servo_; }

  // One step is: begin_step, then guess_friction or bound_friction, the solver, and read_state. After a guess
  // the solver's answer must be confirmed; one that is not calls for another solution from the same state,
  // with the guess corrected.
  void begin_step();
  // Takes friction as known: the joint slides one way, or is locked by a single unbounded row. Cheap for the
  // solver.
  void guess_friction();
  // Leaves it to the solver: a row bounded by Kc. Always right, and dear.
  void bound_friction();
  // Whether the solution obeys Coulomb: a locked joint held by less than Kc, a slow slider that did not turn
  // round. If not, corrects the guess.
  bool confirm_friction();
  void read_state();

  const JointState& state() const { return state_; }
  const Wrench& wrench() const { return wrench_; }

 private:
  struct Feedbacks {
    dJointFeedback hinge{};
    dJointFeedback motor{};
  };
  enum class Friction {
    kSliding,   // fast enough to slide on in its direction, whatever happens in this step
    kCreeping,  // slow, and guessed to slide
    kLocked,    // slow, and guessed to stick
    kBounded    // slow, and the solver decides
  };

  void set_stop(const JointDescription& joint);
  void write_rows();

  double step_s_;
  double lower_rad_;
  double upper_rad_;
  dBodyID parent_;
  OdeJoint hinge_;
  OdeJoint motor_;
  std::unique_ptr<Feedbacks> feedbacks_;  // ODE writes into it, so it never moves
  ServoTorque servo_;
  JointState state_;
  Wrench wrench_;
  Friction friction_ = Friction::kLocked;
  double direction_ = 0.0;  // of sliding or creeping
  // When the step began:
  Eigen::Vector3d axis_W_ = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d p_AnchorParentCom_W_ = Eigen::Vector3d::Zero();
};

}  // namespace koboshi::sim
