#pragma once

#include <ode/ode.h>

#include <Eigen/Core>

#include "sim_board/robot/description.h"
#include "sim_board/world/ode_library.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// A hinge with a servo inside the constraint solver. ODE solves each row as J v_new = vel - CFM lambda, with
// lambda in N m bounded by +-FMax. An angular motor with three parallel axes carries three such rows:
//   drive     the torque a - b w_new: vel = a/b, CFM = 1/b, no bound. The rotor's inertia J is in it, J/h
//   w_old in a and
//             J/h in b, and so is sliding friction, -sign(w_old) Kc in a.
//   friction  when the joint hardly moves: vel = 0, FMax = Kc. The row stops the joint as long as Kc
//   suffices. stop      the joint's limits as a spring and damper. Never on the axis of the drive: ODE
//   applies a powered axis'
//             bound as a torque at its stop.
class ServoJoint {
 public:
  // The bodies must stand as at joint zero, with the model frame in the world's. `start_rad` is where the
  // caller moves them.
  ServoJoint(dWorldID world, const JointDescription& joint, dBodyID child, dBodyID parent, double start_rad,
             double step_s);

  void set_servo(const ServoTorque& torque) { servo_ = torque; }
  const ServoTorque& servo() const { return servo_; }
  // Before the solver.
  void prepare();
  // After the solver: reads state and wrench.
  void read_state();

  const JointState& state() const { return state_; }
  const Wrench& wrench() const { return wrench_; }

 private:
  struct Feedbacks {
    dJointFeedback hinge{};
    dJointFeedback motor{};
  };

  void set_stop(const JointDescription& joint);

  double step_s_;
  dBodyID parent_;
  OdeJoint hinge_;
  OdeJoint motor_;
  std::unique_ptr<Feedbacks> feedbacks_;  // ODE writes into it, so it never moves
  ServoTorque servo_;
  JointState state_;
  Wrench wrench_;
  Eigen::Vector3d p_AnchorParentCom_W_ = Eigen::Vector3d::Zero();  // when the last step began
};

}  // namespace koboshi::sim
