#include "sim_board/engine/mujoco/mujoco_world.h"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "sim_board/description/hinge_tree.h"
#include "sim_board/engine/common/limits.h"
#include "sim_board/engine/mujoco/has_mujoco.h"
#include "sim_board/engine/mujoco/scene.h"

namespace koboshi::sim_board {
namespace {

class MujocoWorld final : public World {
 public:
  MujocoWorld(const RobotDescription& robot, const WorldOptions& options);

  void set_servo(int joint, const ServoTorque& torque) override { servos_.at(at(joint)) = torque; }
  void push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) override;
  void release_base() override;
  void step() override;

  double step_s() const override { return options_.step_s; }
  double time_s() const override { return static_cast<double>(steps_) * options_.step_s; }
  JointState joint(int joint) const override;
  BodyState body(int link) const override { return scene_->body(link); }
  Wrench joint_wrench(int joint) const override { return wrenches_.at(at(joint)); }
  std::span<const Contact> contacts() const override { return contacts_; }
  std::uint64_t solver_warnings() const override { return earlier_warnings_ + scene_->warnings(); }
  std::uint64_t unsettled_steps() const override { return earlier_unsettled_ + scene_->unsettled_steps(); }
  void archive(StateArchive& archive) override;

 private:
  static std::size_t at(int number) { return static_cast<std::size_t>(number); }
  void check_links() const;
  void solve();
  void read_solution();
  void check_inputs() const;
  void check_bodies() const;

  const RobotDescription robot_;  // its followers are joints
  const WorldOptions options_;
  const std::vector<FollowerDescription> followers_;
  std::vector<TouchingPair> pairs_;
  std::optional<Scene> scene_;
  bool held_;  // the base is fixed to its stand
  std::uint64_t steps_ = 0;
  std::uint64_t earlier_warnings_ = 0;  // of the scene before the release of the base
  std::uint64_t earlier_unsettled_ = 0;
  // Indexed by joint:
  std::vector<ServoTorque> servos_;
  std::vector<double> servo_Nm_;
  std::vector<Wrench> wrenches_;
  std::vector<Contact> contacts_;
};

MujocoWorld::MujocoWorld(const RobotDescription& robot, const WorldOptions& options)
    : robot_(with_followers_as_joints(robot)),
      options_(with_follower_positions(checked(options, robot), robot)),
      followers_(robot.followers),
      held_(options_.fixed_base) {
  check_links();
  pairs_ = touching_pairs(robot_, hinge_tree(robot_), options_);
  scene_.emplace(robot_, followers_, pairs_, options_, held_ ? Base::kFixed : Base::kFree);
  servos_.resize(robot_.joints.size());
  servo_Nm_.resize(robot_.joints.size());
  wrenches_.resize(robot_.joints.size());
  contacts_.reserve(kMaxContacts);
}

void MujocoWorld::check_links() const {
  for (const LinkDescription& link : robot_.links)
    if (!(link.mass_kg > 0.0) || link.I_LCom_L.llt().info() != Eigen::Success)
      throw std::invalid_argument("link '" + link.name + "' has no positive mass and inertia");
}

void MujocoWorld::push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) {
  check_push(time_s(), robot_.links.at(at(link)), p_L, f_W);
  scene_->push(link, body(link).X_WL * p_L, f_W);
}

// A fixed base belongs to MuJoCo's world body, a released one is a free body, so each needs its own model.
void MujocoWorld::release_base() {
  if (!held_) return;
  held_ = false;
  earlier_warnings_ += scene_->warnings();
  earlier_unsettled_ += scene_->unsettled_steps();
  Scene free(robot_, followers_, pairs_, options_, Base::kFree);
  free.take_joints_from(*scene_);
  scene_.emplace(std::move(free));
}

void MujocoWorld::step() {
  check_inputs();
  for (std::size_t j = 0; j < servos_.size(); ++j) scene_->set_servo(static_cast<int>(j), servos_[j]);
  ++steps_;
  solve();
  read_solution();
  scene_->move();
  check_bodies();
}

void MujocoWorld::solve() {
  try {
    scene_->solve();
  } catch (const MujocoError& error) {
    blow_up(time_s(), "MuJoCo", error.what());
  }
  if (!scene_->is_finite()) blow_up(time_s(), "MuJoCo", "an acceleration that is not finite");
}

void MujocoWorld::read_solution() {
  for (std::size_t j = 0; j < servos_.size(); ++j) {
    servo_Nm_[j] = scene_->servo_Nm(static_cast<int>(j), servos_[j]);
    wrenches_[j] = scene_->joint_wrench(static_cast<int>(j));
  }
  contacts_.clear();
  scene_->read_contacts(contacts_);
}

JointState MujocoWorld::joint(int joint) const {
  return {scene_->position_rad(joint), scene_->speed_rad_per_s(joint), servo_Nm_.at(at(joint))};
}

void MujocoWorld::archive(StateArchive& archive) {
  const bool was_held = held_;
  archive(held_);
  // Recompiling the other model takes some milliseconds.
  if (held_ != was_held)
    scene_.emplace(robot_, followers_, pairs_, options_, held_ ? Base::kFixed : Base::kFree);
  archive(scene_, steps_, earlier_warnings_, earlier_unsettled_, servos_, servo_Nm_, wrenches_, contacts_);
}

void MujocoWorld::check_inputs() const {
  for (std::size_t j = 0; j < servos_.size(); ++j) check_servo(time_s(), robot_.joints[j], servos_[j]);
}

void MujocoWorld::check_bodies() const {
  for (std::size_t l = 0; l < robot_.links.size(); ++l) {
    const BodyState state = body(static_cast<int>(l));
    check_body(time_s(), robot_.links[l], options_, state.X_WL, state.v_WCom_W, state.w_WL_W);
  }
}

}  // namespace

bool has_mujoco() { return true; }

std::unique_ptr<World> make_mujoco_world(const RobotDescription& robot, const WorldOptions& options) {
  try {
    return std::make_unique<MujocoWorld>(robot, options);
  } catch (const MujocoError& error) {
    throw std::invalid_argument(std::string("MuJoCo makes no world of robot '") + robot.name +
                                "': " + error.what());
  }
}

}  // namespace koboshi::sim_board
