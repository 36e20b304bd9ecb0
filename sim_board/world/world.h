#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace koboshi::sim {

// What a servo asks of the solver for one step: a torque affine in the joint's new speed,
// tau = drive_Nm - damping_Nm_s * w_new, and a bound on the dry friction that opposes the motion.
struct ServoTorque {
  double drive_Nm = 0.0;        // a, without the rotor's inertial term
  double damping_Nm_s = 0.0;    // b, without the rotor's inertial term
  double rotor_inertia_kg_m2 = 0.0;
  double friction_Nm = 0.0;     // largest magnitude of dry friction
};

struct JointState {
  double position_rad = 0.0;
  double speed_rad_per_s = 0.0;
};

struct BodyState {
  Eigen::Isometry3d X_WL = Eigen::Isometry3d::Identity();  // link frame in the world
  Eigen::Vector3d v_WCom_W = Eigen::Vector3d::Zero();      // velocity of the centre of mass
  Eigen::Vector3d w_WL_W = Eigen::Vector3d::Zero();
};

// Force and torque about a point that the comment of the function names.
struct Wrench {
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_Nm = Eigen::Vector3d::Zero();
};

// One point where a link touches the ground or another link, after a step.
struct Contact {
  int link = -1;
  int other_link = -1;  // -1: the ground
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d f_W = Eigen::Vector3d::Zero();  // what `link` feels
};

// Physics that left the finite: the run ends with this. `what()` names time, body and reason.
class WorldBlewUp : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A robot and its ground in a physics engine. Several may live in one process, each in any thread, one thread at a time.
// Links and joints are numbered as in the RobotDescription.
class World {
 public:
  virtual ~World() = default;

  // Applies to every following step, until set again.
  virtual void set_servo(int joint, const ServoTorque& torque) = 0;
  // Force at a point fixed in the link's frame, for the next step only.
  virtual void push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) = 0;
  // Advances by one step of step_s(). Throws WorldBlewUp.
  virtual void step() = 0;

  virtual double step_s() const = 0;
  virtual double time_s() const = 0;
  virtual JointState joint(int joint) const = 0;
  virtual BodyState body(int link) const = 0;
  // What the world below a joint exerts on the joint's child through it during the last step is minus what crosses the joint;
  // returned is the wrench that the child side exerts on the parent side, about the joint's anchor, in world axes.
  virtual Wrench joint_wrench(int joint) const = 0;
  // Contacts of the last step. Valid until the next.
  virtual std::span<const Contact> contacts() const = 0;
  // Complaints of the solver since the world was made.
  virtual std::uint64_t solver_warnings() const = 0;
};

}  // namespace koboshi::sim
