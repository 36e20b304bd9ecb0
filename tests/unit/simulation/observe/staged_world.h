#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "mechanics/hinge_tree.h"
#include "sim_board/description/hinge_tree.h"
#include "sim_board/world/world.h"

namespace koboshi::simulation {

// A world whose state the test sets.
class StagedWorld final : public sim_board::World {
 public:
  explicit StagedWorld(const sim_board::RobotDescription& robot)
      : tree_(sim_board::hinge_tree(robot)), robot_(robot) {
    pose(Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 0.17)));
  }

  void pose(const Eigen::Isometry3d& X_WB) {
    X_WLs_ = tree_.poses(X_WB, std::vector<double>(robot_.joints.size(), 0.0));
  }
  void load(int link, double force_N, const Eigen::Vector3d& p_W = Eigen::Vector3d::Zero()) {
    contacts_.push_back({.link = link, .p_W = p_W, .f_W = Eigen::Vector3d(0.0, 0.0, force_N)});
  }
  void touch(int link, int other_link) { contacts_.push_back({.link = link, .other_link = other_link}); }
  void unload() { contacts_.clear(); }

  void set_servo(int, const sim_board::ServoTorque&) override {}
  void push(int, const Eigen::Vector3d&, const Eigen::Vector3d&) override {}
  void release_base() override {}
  void step() override {}
  double step_s() const override { return 0.001; }
  double time_s() const override { return 0.0; }
  sim_board::JointState joint(int) const override { return {}; }
  sim_board::BodyState body(int link) const override {
    return {.X_WL = X_WLs_[static_cast<std::size_t>(link)]};
  }
  sim_board::Wrench joint_wrench(int) const override { return {}; }
  std::span<const sim_board::Contact> contacts() const override { return contacts_; }
  std::uint64_t solver_warnings() const override { return 0; }
  void archive(sim_board::StateArchive&) override {}

 private:
  mechanics::HingeTree tree_;
  const sim_board::RobotDescription& robot_;
  std::vector<Eigen::Isometry3d> X_WLs_;
  std::vector<sim_board::Contact> contacts_;
};

}  // namespace koboshi::simulation
