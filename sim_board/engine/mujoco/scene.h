#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "sim_board/description/description.h"
#include "sim_board/engine/mujoco/library.h"
#include "sim_board/engine/mujoco/lift_iteration.h"
#include "sim_board/engine/mujoco/model_text.h"
#include "sim_board/state/archive.h"
#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// A MuJoCo model and its data, with the indices of the RobotDescription. The sequence of a step is:
// set_servo() and push(), solve(), read the results, move().
//
// A servo's torque a - b w', with w' the speed at the end of the step, and its rotor inertia J are part of
// the equations of motion instead of an applied force:
//   (J + h b) (w' - w)/h = a - b w + ...
// is J (w' - w)/h = a - b w' + ..., so the joint's armature is J + h b and the force is a - b w. The contact
// solver thereby accounts for both; MuJoCo's own damping would be applied only after it.
//
// Dry friction is a force on a sliding joint, and a bounded solver row on a joint that may stick.
class Scene {
 public:
  // Creates the robot at rest in the given pose. The followers are its last joints. Throws MujocoError if
  // MuJoCo rejects the model.
  Scene(const RobotDescription& robot, std::span<const FollowerDescription> followers,
        const std::vector<TouchingPair>& pairs, const WorldOptions& options, Base base);

  // Copies the joints' positions and speeds from another scene; the base is at rest.
  void take_joints_from(const Scene& other);

  void set_servo(int joint, const ServoTorque& servo);
  // Applies a force at a point of the world in the next step; several forces add up.
  void push(int link, const Eigen::Vector3d& p_W, const Eigen::Vector3d& f_W);

  // Computes accelerations and constraint forces of a step from the present poses.
  void solve();
  bool is_finite() const;  // checks the solution
  // Returns the torque of servo, rotor and dry friction on the joint's child.
  double servo_Nm(int joint, const ServoTorque& servo) const;
  // World::joint_wrench.
  Wrench joint_wrench(int joint) const;
  // Appends the contacts (World::contacts).
  void read_contacts(std::vector<Contact>& contacts) const;
  // Ends the step: integrates speeds and poses.
  void move();

  double position_rad(int joint) const { return data_->qpos[numbers_[index(joint)].position]; }
  double speed_rad_per_s(int joint) const { return data_->qvel[numbers_[index(joint)].speed]; }
  BodyState body(int link) const;
  // MuJoCo's warnings plus the steps in which its solver did not converge, since the scene was created.
  std::uint64_t warnings() const;
  // World::unsettled_steps since the scene was created.
  std::uint64_t unsettled_steps() const { return unsettled_; }

  // Call it between move() and the next set_servo(). All other data of MuJoCo follow from this state.
  void archive(StateArchive& archive);

 private:
  struct JointNumbers {
    int joint;
    int position;  // index in qpos
    int speed;     // index in qvel and all other arrays by degree of freedom
    int child;     // index of the body
  };

  static std::size_t index(int number) { return static_cast<std::size_t>(number); }
  int body_of(int link) const { return bodies_.at(index(link)); }
  void find_numbers(const RobotDescription& robot);
  void update_poses();
  void drop_false_contacts();
  void drop_far_contacts();
  void aim_normals(double impact_share);
  void solve_contacts(double impact_share);
  double impact_work_J() const;
  void harden(const mjContact& contact);
  void solve_sliding();
  std::span<const double> slips();
  void lower_aims();

  MujocoModel model_;
  MujocoData data_;
  std::vector<int> bodies_;            // by link
  std::vector<JointNumbers> numbers_;  // by joint
  std::vector<double> sliding_Nm_;     // by joint: friction applied as a force
  // The positions from which the poses were computed. MuJoCo then normalises the base's quaternion in place,
  // and a second normalisation would change its last bits.
  std::vector<double> integrated_;
  std::vector<int> links_;  // by geom; -1: the ground
  std::vector<TouchingPair> pairs_;
  std::vector<char> is_impact_;     // by contact
  std::vector<int> pair_of_geoms_;  // by the one geom times their number plus the other; -1: none
  LiftIteration iteration_{kMaxContacts};
  std::vector<double> lift_m_per_s_;      // by contact: lift of its normal row
  std::vector<double> slip_m_per_s_;      // by contact: mu |v_t| of the solution
  std::vector<double> row_acceleration_;  // of the constraints, m/s^2 or rad/s^2
  std::uint64_t unconverged_ = 0;
  std::uint64_t unsettled_ = 0;
};

}  // namespace koboshi::sim_board
