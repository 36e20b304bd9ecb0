#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <stdexcept>

#include "sim_board/state/archive.h"

namespace koboshi::sim {

// What a servo asks of the solver: a torque affine in the joint's new speed, tau = drive_Nm - damping_Nm_s *
// w_new, the inertia of its rotor, and a bound on the dry friction that opposes the motion. All at the joint,
// output side.
struct ServoTorque {
  double drive_Nm = 0.0;      // a, without the rotor's inertial term
  double damping_Nm_s = 0.0;  // b, without the rotor's inertial term
  double rotor_inertia_kg_m2 = 0.0;
  double friction_Nm = 0.0;  // largest magnitude of dry friction
};

struct JointState {
  double position_rad = 0.0;  // continuous: counts turns beyond +-pi
  double speed_rad_per_s = 0.0;
  // What the servo (motor, friction, rotor) gave the joint's child in the last step, about the axis; its
  // gears carry the opposite. The joint's stops are not in it.
  double servo_Nm = 0.0;
};

struct BodyState {
  Eigen::Isometry3d X_WL = Eigen::Isometry3d::Identity();  // link frame in the world
  Eigen::Vector3d v_WCom_W = Eigen::Vector3d::Zero();      // velocity of the centre of mass, m/s
  Eigen::Vector3d w_WL_W = Eigen::Vector3d::Zero();        // rad/s
};

// Force and torque about a point that the comment of the function names.
struct Wrench {
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_Nm = Eigen::Vector3d::Zero();
};

// One point where a link touched the ground or another link during the last step.
struct Contact {
  int link = -1;
  int other_link = -1;  // -1: the ground
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d n_W = Eigen::Vector3d::UnitZ();  // unit normal, out of the other and into `link`
  Eigen::Vector3d f_W = Eigen::Vector3d::Zero();   // what `link` feels, N; the other feels the opposite
  double depth_m = 0.0;                            // of the overlap when the step began
};

// Physics that left the finite: the run ends with this. `what()` names time, body and reason.
class WorldBlewUp : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A robot and its ground in a physics engine. Several may live in one process, each in any thread, one thread
// at a time. Links and joints are numbered as in the RobotDescription.
class World {
 public:
  virtual ~World() = default;

  // Applies to every following step, until set again.
  virtual void set_servo(int joint, const ServoTorque& torque) = 0;
  // Force at a point given in the link's frame, for the next step only. Several in one step add up.
  virtual void push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) = 0;
  // Lets go of a base that hung on a stand. No effect otherwise.
  virtual void release_base() = 0;
  // Advances by one step of step_s(). Throws WorldBlewUp.
  virtual void step() = 0;

  virtual double step_s() const = 0;
  virtual double time_s() const = 0;
  virtual JointState joint(int joint) const = 0;
  virtual BodyState body(int link) const = 0;
  // The whole wrench (hinge, stop, motor and friction) that the joint's child exerted on its parent during
  // the last step, about the joint's anchor, in world axes. A robot that stands: the foot, child of the
  // ankle, pushes the shank up, so force_N.z() > 0. Zero before the first step.
  virtual Wrench joint_wrench(int joint) const = 0;
  // Contacts of the last step, ordered alike in every run. Valid until the next.
  virtual std::span<const Contact> contacts() const = 0;
  // Complaints of the solver since the world was made.
  virtual std::uint64_t solver_warnings() const = 0;
  // Steps since the world was made in which contacts that slide were left further from Coulomb's law than the
  // engine's tolerance. Always zero in an engine that solves the law directly.
  virtual std::uint64_t unsettled_steps() const { return 0; }

  // Saves or restores the state between two steps. A world that is restored steps on to the same bits.
  virtual void archive(StateArchive& archive) = 0;
};

}  // namespace koboshi::sim
