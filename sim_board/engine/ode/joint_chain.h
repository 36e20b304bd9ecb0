#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "sim_board/engine/ode/bodies.h"
#include "sim_board/engine/ode/hinge_chains.h"
#include "sim_board/engine/ode/library.h"
#include "sim_board/engine/ode/servo_motor.h"
#include "sim_board/robot/description.h"
#include "sim_board/state/archive.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// A chain of hinges as one joint of ODE (a hinge, a universal joint or a ball) with a servo motor for each
// hinge, and the links between them, whose motion follows from that of the two bodies.
//
// The hinges' axes a_i, as they stand, give the angular velocity w = sum a_i speed_i of child against parent.
// It changes by a_i of the speeds' changes, and as the axes turn. Torques are dual to speeds: a servo's
// torque tau_i acts as tau_i b_i, where b_i . a_j = 1 for i = j and 0 otherwise. With a ball the middle axis
// is perpendicular to both others, and b_1, b_3 grow as 1/cos of the middle hinge's position: it has its
// stops at 85 degrees at the latest, before the gimbal lock.
class JointChain {
 public:
  static constexpr std::size_t kMostHinges = 3;

  // The bodies must stand as at joint zero, with the model frame in the world's. `starts_rad`, by joint of
  // the robot, is where the caller moves them. All arguments must outlive the chain but `starts_rad`.
  JointChain(dWorldID world, const RobotDescription& robot, const HingeChain& chain, const Bodies& bodies,
             std::span<const double> starts_rad, double step_s);

  const HingeChain& hinges() const { return chain_; }
  ServoMotor& motor(std::size_t i) { return motors_[i]; }
  const ServoMotor& motor(std::size_t i) const { return motors_[i]; }

  // As ServoMotor's, for all hinges.
  void begin_step();
  void guess_friction();
  void bound_friction();
  // Whether the solution obeys Coulomb at all hinges; corrects the guess of those where it does not.
  bool confirm_friction();
  void finish_step();

  // World::joint_wrench of hinge i, in a world of this gravity.
  Wrench wrench(std::size_t i, const Eigen::Vector3d& gravity_W_m_per_s2) const;
  // The link behind hinge i, which is not the last.
  BodyState link_between(std::size_t i) const;

  void archive(StateArchive& archive) { archive(*feedback_, motors_, p_AnchorParentCom_W_, before_); }

 private:
  using Vectors = std::array<Eigen::Vector3d, kMostHinges>;
  // What a link between the hinges needs for Newton and Euler.
  struct Motion {
    Eigen::Matrix3d R_WL = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p_ACom_W = Eigen::Vector3d::Zero();  // from the anchor to its centre of mass
    Eigen::Vector3d v_WCom_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d w_W = Eigen::Vector3d::Zero();
  };

  const JointDescription& joint(std::size_t i) const;
  const LinkDescription& link(std::size_t i) const;
  std::size_t size() const { return chain_.joints.size(); }
  Eigen::Matrix3d R_WParent() const;  // of the model frame as it moves with the parent
  Eigen::Matrix3d R_WChild() const;
  Eigen::Vector3d relative_rate_W() const;
  Eigen::Vector3d p_WAnchor_W() const;
  std::array<double, kMostHinges> positions_rad() const;
  Vectors axes_W() const;  // for the positions of the last step
  Vectors duals(const Vectors& axes_W) const;
  Eigen::Vector3d turning_of_axes_W(const Vectors& axes_W) const;
  Motion motion(std::size_t i, const Vectors& axes_W) const;

  const RobotDescription& robot_;
  const HingeChain chain_;
  dBodyID parent_;
  dBodyID child_;
  double step_s_;
  Eigen::Matrix3d R_ParentM_;  // model frame's axes in the parent's
  Eigen::Matrix3d R_ChildM_;
  Eigen::Vector3d p_ParentAnchor_;  // from the parent body's centre of mass, in its axes
  Eigen::Matrix3d R_MF_;            // columns: first axis, second axis, their cross product
  double third_sign_ = 1.0;         // the third axis is this times the third column
  OdeJoint constraint_;
  std::unique_ptr<dJointFeedback> feedback_;  // ODE writes into it, so it never moves
  std::vector<ServoMotor> motors_;
  // When the step began:
  Eigen::Vector3d p_AnchorParentCom_W_ = Eigen::Vector3d::Zero();
  std::array<Motion, kMostHinges - 1> before_;
};

}  // namespace koboshi::sim
