#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "sim_board/engine/mujoco/library.h"
#include "sim_board/engine/mujoco/lift_iteration.h"
#include "sim_board/engine/mujoco/model_text.h"
#include "sim_board/robot/description.h"
#include "sim_board/state/archive.h"
#include "sim_board/world/link_tree.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// A model of MuJoCo and its data, in the numbers of the RobotDescription. A step is: set_servo() and push(),
// solve(), the functions that tell what was solved, move().
//
// A servo's torque a - b w', with w' the speed at the end of the step, and its rotor's inertia J are part of
// the equations of motion, not a force upon them:
//   (J + h b) (w' - w)/h = a - b w + ...
// is J (w' - w)/h = a - b w' + ..., so that the joint's armature is J + h b and the force a - b w. The solver
// of the contacts so knows them, which it does not know of MuJoCo's own damping: that is added afterwards.
//
// Dry friction is a force on a joint that slides, and a bounded row of the solver on one that may stick.
class Scene {
 public:
  // The robot at rest as the options say. Throws MujocoError for a robot that MuJoCo takes for none.
  Scene(const RobotDescription& robot, const std::vector<TouchingPair>& pairs, const WorldOptions& options,
        Base base);

  // Takes over where the joints of the other are, and how fast; the base is at rest.
  void take_joints_from(const Scene& other);

  void set_servo(int joint, const ServoTorque& servo);
  // A force at a point of the world, until the step is solved; several add up.
  void push(int link, const Eigen::Vector3d& p_W, const Eigen::Vector3d& f_W);

  // Accelerations and constraint forces of a step from the present poses.
  void solve();
  bool is_finite() const;  // what was solved
  // What the servo, with rotor and dry friction, gives the joint's child.
  double servo_Nm(int joint, const ServoTorque& servo) const;
  // World::joint_wrench.
  Wrench joint_wrench(int joint) const;
  // World::contacts, appended.
  void read_contacts(std::vector<Contact>& contacts) const;
  // Ends the step: new speeds, and with them new poses.
  void move();

  double position_rad(int joint) const { return data_->qpos[numbers_[index(joint)].position]; }
  double speed_rad_per_s(int joint) const { return data_->qvel[numbers_[index(joint)].speed]; }
  BodyState body(int link) const;
  // Complaints of MuJoCo, and steps in which its solver did not converge, since the scene was made.
  std::uint64_t warnings() const;
  // World::unsettled_steps, since the scene was made.
  std::uint64_t unsettled_steps() const { return unsettled_; }

  // Between move() and the next set_servo(). All else in MuJoCo's data follows from it.
  void archive(StateArchive& archive);

 private:
  struct JointNumbers {
    int joint;
    int position;  // in qpos
    int speed;     // in qvel and all else by degree of freedom
    int child;     // body
  };

  static std::size_t index(int number) { return static_cast<std::size_t>(number); }
  int body_of(int link) const { return bodies_.at(index(link)); }
  void find_numbers(const RobotDescription& robot);
  void update_poses();
  void bounce();
  void solve_sliding();
  std::span<const double> slips();
  void lower_aims();

  MujocoModel model_;
  MujocoData data_;
  std::vector<int> bodies_;            // by link
  std::vector<JointNumbers> numbers_;  // by joint
  std::vector<double> sliding_Nm_;     // by joint: friction that is no row
  // The positions from which the poses were computed. MuJoCo then makes the base's quaternion a unit one in
  // place, and doing that twice changes its last bits.
  std::vector<double> integrated_;
  std::vector<int> links_;             // by geom; -1: the ground
  std::vector<TouchingPair> bouncing_;
  std::vector<int> bouncing_of_geoms_;  // by one geom times their number plus the other; -1: does not bounce
  LiftIteration iteration_{kMostContacts};
  std::vector<double> lift_m_per_s_;      // by contact: mu |v_t|, as its normal row knows it
  std::vector<double> slip_m_per_s_;      // by contact: mu |v_t| of the solution
  std::vector<double> row_acceleration_;  // of the constraints, m/s^2 or rad/s^2
  std::uint64_t unconverged_ = 0;
  std::uint64_t unsettled_ = 0;
};

}  // namespace koboshi::sim
