#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "sim_board/description/description.h"
#include "sim_board/engine/ode/library.h"
#include "sim_board/engine/tree/tree_solver.h"
#include "sim_board/state/archive.h"
#include "sim_board/world/surface_contact.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

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

  // Sequence of a step: begin_step; at will bound_friction; write_ode_rows, or write_tree_axis and add_rows;
  // the solver, and for the tree read_tree; set_position and set_speed. After a guess, the solution must be
  // confirmed; if it is rejected, the guess is corrected and the step is solved again from the same state.
  // The speed after the step is b . w_new + drift, where the drift is the contribution of b's own rotation.
  void begin_step(const Eigen::Vector3d& b_W, double drift_rad_per_s);
  // Leaves friction to the solver, as a row bounded by Kc: always correct, but expensive to solve. Otherwise
  // friction is a guess, cheap to solve: the joint slides in one direction, or an unbounded row locks it.
  void bound_friction();

  void write_ode_rows();

  // Writes drive and damping of the hinge's axis in the tree.
  void write_tree_axis(mechanics::JointSpace::Axis& axis) const;
  // Appends the bounded rows: friction that the solver decides, and the stop. `child` and `parent` are the
  // bodies' indices in the tree, `dof` is the index of the hinge's axis.
  void add_rows(std::vector<TreeRow>& rows, int child, int parent, std::size_t dof);
  // The hinge's speed after the step is axis_W() . w_new + drift_rad_per_s().
  const Eigen::Vector3d& axis_W() const { return b_W_; }
  double drift_rad_per_s() const { return drift_rad_per_s_; }
  // Call it after add_rows() for a hinge that a row couples to another one: `share` is the torque on this
  // hinge per unit of the row's.
  void couple(std::size_t row, double share) {
    coupling_row_ = static_cast<int>(row);
    coupling_share_ = share;
  }
  // Reads the torques of a solution; `speed_rad_per_s` is that of the tree's axis.
  void read_tree(const TreeSolver& solver, double speed_rad_per_s);

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
  // Torque on the child that the tree's axis exerted, without the bounded rows.
  Eigen::Vector3d tree_torque_W_Nm() const { return tree_Nm_ * b_W_; }
  // Torque of servo, stop and coupling on the parent in the last step; they exert no force.
  Eigen::Vector3d on_parent_Nm() const;

  // The rows of ODE's motors are rewritten in each step.
  void archive(StateArchive& archive);

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

  // The servo's torque without that of a bounded friction row: at_rest - damping * speed.
  struct Torque {
    double at_rest_Nm = 0.0;
    double damping_Nm_s = 0.0;
  };

  void write_ode_stop();
  Torque unbounded_torque() const;  // of a joint that is not locked
  Torque tree_torque() const;
  double servo_Nm() const;
  double friction_Nm(double speed_rad_per_s) const;
  bool slides() const { return friction_ == Friction::kSliding || friction_ == Friction::kCreeping; }
  bool is_locked() const { return friction_ == Friction::kLocked && servo_.friction_Nm > 0.0; }

  static constexpr int kNoRow = -1;

  double step_s_;
  double lower_rad_;
  double upper_rad_;
  Softness stop_softness_;
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
  // Rows of the tree's solver in this step:
  int friction_row_ = kNoRow;
  int stop_row_ = kNoRow;
  int coupling_row_ = kNoRow;
  double coupling_share_ = 0.0;
  double tree_Nm_ = 0.0;  // torque of the tree's axis, without those rows
};

}  // namespace koboshi::sim_board
