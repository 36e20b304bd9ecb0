#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <stdexcept>

#include "sim_board/state/archive.h"
#include "sim_board/world/free_body.h"

namespace koboshi::sim_board {

// Servo input to the solver: a torque affine in the joint's new speed, tau = drive_Nm - damping_Nm_s * w_new,
// the rotor inertia, and a bound of the dry friction. All at the joint, output side.
struct ServoTorque {
  double drive_Nm = 0.0;      // a, without the rotor's inertial term
  double damping_Nm_s = 0.0;  // b, without the rotor's inertial term
  double rotor_inertia_kg_m2 = 0.0;
  double friction_Nm = 0.0;  // bound of the dry friction's magnitude
};

struct JointState {
  double position_rad = 0.0;  // continuous: may exceed +-pi
  double speed_rad_per_s = 0.0;
  // Torque of the servo (motor, friction, rotor) on the joint's child in the last step, about the axis,
  // without the joint's stops. Its reaction acts on the parent.
  double servo_Nm = 0.0;
};

struct BodyState {
  Eigen::Isometry3d X_WL = Eigen::Isometry3d::Identity();  // link frame in the world
  Eigen::Vector3d v_WCom_W = Eigen::Vector3d::Zero();      // velocity of the centre of mass, m/s
  Eigen::Vector3d w_WL_W = Eigen::Vector3d::Zero();        // rad/s
};

// Force and torque; the function's comment names the reference point.
struct Wrench {
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_Nm = Eigen::Vector3d::Zero();
};

// A contact point of a link with the ground or another link during the last step.
struct Contact {
  int link = -1;
  int other_link = -1;  // -1: the ground
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d n_W = Eigen::Vector3d::UnitZ();  // unit normal, from the other body towards `link`
  Eigen::Vector3d f_W = Eigen::Vector3d::Zero();   // force on `link`, N; the other body feels the opposite
  double depth_m = 0.0;                            // penetration at the beginning of the step
};

// The simulation has diverged; this ends the run. `what()` gives time, body and reason.
class WorldBlewUp : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A robot and its ground in a physics engine. A process may contain several worlds; each may be used from any
// thread, by one thread at a time. Links and joints are numbered as in the RobotDescription.
class World {
 public:
  virtual ~World() = default;

  // Applies to all following steps until set again.
  virtual void set_servo(int joint, const ServoTorque& torque) = 0;
  // Applies a force at a point in the link's frame, for the next step only. Several forces add up.
  virtual void push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) = 0;
  // Releases a base that is fixed to a stand; otherwise no effect.
  virtual void release_base() = 0;
  // Advances by one step of step_s(). Throws WorldBlewUp.
  virtual void step() = 0;

  virtual double step_s() const = 0;
  virtual double time_s() const = 0;
  virtual JointState joint(int joint) const = 0;
  virtual BodyState body(int link) const = 0;
  // Total wrench (hinge, stop, motor and friction) of the joint's child on its parent during the last step,
  // about the joint's anchor, in world axes. On a standing robot the foot, child of the ankle, pushes the
  // shank up: force_N.z() > 0. Zero before the first step.
  virtual Wrench joint_wrench(int joint) const = 0;
  // Contacts of the last step, in the same order in every run. Valid until the next step.
  virtual std::span<const Contact> contacts() const = 0;
  // Number of solver warnings since the world was created.
  virtual std::uint64_t solver_warnings() const = 0;
  // Number of steps in which contacts were left further from Coulomb's law than the engine's tolerance.
  virtual std::uint64_t unsettled_steps() const { return 0; }

  // The free bodies, in the order of WorldOptions::free_bodies. Valid until the next step.
  virtual std::span<const FreeBodyState> free_bodies() const { return {}; }
  // By free body: a link of the robot that it touched in the last step; -1: none. The forces act on the links
  // as pushes, and are not among contacts().
  virtual std::span<const int> links_at_free_bodies() const { return {}; }

  // Saves or restores the state between two steps. A restored world continues with the same bits.
  virtual void archive(StateArchive& archive) = 0;
};

}  // namespace koboshi::sim_board
