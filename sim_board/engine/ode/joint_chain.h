#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "sim_board/description/description.h"
#include "sim_board/engine/ode/bodies.h"
#include "sim_board/engine/ode/hinge_chains.h"
#include "sim_board/engine/ode/library.h"
#include "sim_board/engine/ode/servo_motor.h"
#include "sim_board/state/archive.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// A chain of hinges as one ODE joint (hinge, universal joint or ball) with a servo motor per hinge. The
// motion of the links in between follows from that of the two bodies.
//
// The present hinge axes a_i give the relative angular velocity w = sum a_i speed_i of the child. It changes
// with the speeds and as the axes turn. Torques are dual to speeds: a servo's torque tau_i acts as tau_i b_i,
// where b_i . a_j = 1 for i = j and 0 otherwise. In a ball joint the middle axis is perpendicular to both
// others, and b_1, b_3 grow as 1/cos of the middle hinge's position. The middle hinge therefore has stops at
// no more than 85 degrees, before the gimbal lock.
class JointChain {
 public:
  static constexpr std::size_t kMaxHinges = 3;

  // The bodies must be in the pose of joint angles zero, with the model frame equal to the world frame.
  // `starts_rad`, by joint of the robot, are the positions to which the caller then moves them. All arguments
  // except `starts_rad` must outlive the chain.
  JointChain(dWorldID world, const RobotDescription& robot, const HingeChain& chain, const Bodies& bodies,
             std::span<const double> starts_rad, double step_s);

  const HingeChain& hinges() const { return chain_; }
  // Indices in Bodies::all().
  std::size_t parent_index() const { return parent_index_; }
  std::size_t child_index() const { return child_index_; }
  ServoMotor& motor(std::size_t i) { return motors_[i]; }
  const ServoMotor& motor(std::size_t i) const { return motors_[i]; }

  // Reads the poses of the bodies, for the functions below. Call it whenever something else than a step has
  // moved the bodies or restored the hinges; finish_step() calls it itself.
  void place();
  // Same as for ServoMotor, for all hinges.
  void begin_step();
  void bound_friction();
  void write_ode_rows();
  // Writes the tree's joints from `index` on, one for each hinge, and appends the chain's bounded rows.
  // `p_WO_W` is the origin of the tree's spatial vectors.
  void write_tree_joint(const Eigen::Vector3d& p_WO_W, mechanics::JointSpace& tree, std::size_t index,
                        std::vector<TreeRow>& rows);
  // Reads the torques of the tree's solution. `index` is that of the chain's first joint.
  void read_tree_torques(const TreeSolver& solver, std::size_t index);
  // Reads the wrenches at the hinges and the velocities of the links between them from the accepted solution,
  // after the solver has found the joints' impulses. `between` is the tree's body of the first of these
  // links.
  void read_tree_joints(const Eigen::Vector3d& p_WO_W, const TreeSolver& solver, std::size_t index,
                        std::size_t between);
  // The same after ODE's solution and finish_step(). ODE carries the links between the hinges (HingeChain);
  // the wrench is the same at all of them.
  void read_ode_joint();
  // Returns whether the solution satisfies Coulomb's law at all hinges. Corrects the guesses of those where
  // it does not.
  bool confirm_friction();
  void finish_step();

  // World::joint_wrench of hinge i.
  const Wrench& wrench(std::size_t i) const { return wrenches_[i]; }
  // Number of links between the hinges: behind each but the last.
  std::size_t links_between() const { return size() - 1; }
  // Link behind hinge i.
  const LinkDescription& link(std::size_t i) const { return *links_[i]; }
  // State of the link behind hinge i, which must not be the last.
  BodyState link_between(std::size_t i) const;

  void archive(StateArchive& archive);

 private:
  using Vectors = std::array<Eigen::Vector3d, kMaxHinges>;
  // Pose of a link between the hinges.
  struct LinkPose {
    Eigen::Matrix3d R_WL = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p_ACom_W = Eigen::Vector3d::Zero();  // from the anchor to its centre of mass
  };
  // Computed from the poses of the two bodies and the positions of the hinges.
  struct Placement {
    Eigen::Matrix3d R_WParent = Eigen::Matrix3d::Identity();  // of the model frame attached to the parent
    Eigen::Matrix3d R_WChild = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p_ParentAnchor_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_WAnchor_W = Eigen::Vector3d::Zero();
    Vectors axes_W{};
    Vectors duals_W{};
    std::array<LinkPose, kMaxHinges - 1> between;
  };
  struct Velocity {
    Eigen::Vector3d v_WCom_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d w_W = Eigen::Vector3d::Zero();
  };

  const JointDescription& joint(std::size_t i) const { return *joints_[i]; }
  std::size_t size() const { return chain_.joints.size(); }
  Eigen::Vector3d relative_rate_W() const;
  Eigen::Vector3d correcting_rate_W() const;
  void place_bodies();
  void place_hinges();
  std::array<double, kMaxHinges> positions_rad() const;
  Vectors duals(const Vectors& axes_W) const;
  Eigen::Vector3d turning_of_axes_W(const Vectors& axes_W) const;
  Velocity velocity_of_link(std::size_t i) const;  // by those of parent and hinges

  const HingeChain chain_;
  std::array<const JointDescription*, kMaxHinges> joints_{};  // by hinge
  std::array<const LinkDescription*, kMaxHinges> links_{};    // behind each hinge
  dBodyID parent_;
  dBodyID child_;
  std::size_t parent_index_;  // in the bodies
  std::size_t child_index_;
  double step_s_;
  Eigen::Matrix3d R_ParentM_;  // model frame's axes in the parent's
  Eigen::Matrix3d R_ChildM_;
  Eigen::Vector3d p_ParentAnchor_;  // from the parent body's centre of mass, in its axes
  Eigen::Vector3d p_ChildAnchor_;   // the same of the child
  Eigen::Matrix3d R_MF_;            // columns: first axis, second axis, their cross product
  // From the anchor to the centre of mass of each link between the hinges, with all hinges at zero.
  std::array<Eigen::Vector3d, kMaxHinges - 1> p_ACom_M_;
  double third_sign_ = 1.0;  // sign of the third axis relative to the third column
  OdeJoint constraint_;
  std::unique_ptr<dJointFeedback> feedback_;  // must not move, because ODE writes into it
  std::vector<ServoMotor> motors_;
  Placement placement_;  // at the end of the last step
  // Value at the beginning of the step:
  Eigen::Vector3d p_AnchorParentCom_W_ = Eigen::Vector3d::Zero();
  // The last solution:
  std::array<Wrench, kMaxHinges> wrenches_;  // by hinge
  // By link between the hinges: its velocity, as ODE keeps those of its bodies. The velocity that follows
  // from those of the hinges in the pose after the step differs by a term of the order of the step, and so
  // would the sum of momenta.
  std::array<Velocity, kMaxHinges - 1> between_;
};

}  // namespace koboshi::sim_board
