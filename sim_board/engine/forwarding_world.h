#pragma once

#include <memory>
#include <utility>

#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Forwards all calls to another world; base class of worlds that extend or change one.
class ForwardingWorld : public World {
 public:
  explicit ForwardingWorld(std::unique_ptr<World> world) : world_(std::move(world)) {}

  void set_servo(int joint, const ServoTorque& torque) override { world_->set_servo(joint, torque); }
  void push(int link, const Eigen::Vector3d& p_L, const Eigen::Vector3d& f_W) override {
    world_->push(link, p_L, f_W);
  }
  void release_base() override { world_->release_base(); }
  void step() override { world_->step(); }

  double step_s() const override { return world_->step_s(); }
  double time_s() const override { return world_->time_s(); }
  JointState joint(int joint) const override { return world_->joint(joint); }
  BodyState body(int link) const override { return world_->body(link); }
  Wrench joint_wrench(int joint) const override { return world_->joint_wrench(joint); }
  std::span<const Contact> contacts() const override { return world_->contacts(); }
  std::uint64_t solver_warnings() const override { return world_->solver_warnings(); }
  std::uint64_t unsettled_steps() const override { return world_->unsettled_steps(); }
  std::span<const FreeBodyState> free_bodies() const override { return world_->free_bodies(); }
  std::span<const int> links_at_free_bodies() const override { return world_->links_at_free_bodies(); }

  void archive(StateArchive& archive) override { archive(world_); }

 private:
  std::unique_ptr<World> world_;
};

}  // namespace koboshi::sim_board
