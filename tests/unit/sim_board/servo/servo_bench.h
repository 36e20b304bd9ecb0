#pragma once

#include <cmath>
#include <memory>

#include "sim_board/engine/make_world.h"
#include "sim_board/servo/servo.h"
#include "tests/support/sample_robots.h"

namespace koboshi::sim_board {

// A servo that turns an arm in a weightless world, or lifts a weight. Torques come from outside on the arm.
class ServoBench {
 public:
  static constexpr double kArm_m = 0.1;

  explicit ServoBench(const ServoDescription& servo, double step_s = 0.001, double weight_Nm = 0.0,
                      double inertia_kg_m2 = 1e-4)
      : supply_V_(servo.supply_V), steps_a_ms_(std::lround(0.001 / step_s)) {
    HingeRig rig{.inertia_kg_m2 = inertia_kg_m2, .axis = -Eigen::Vector3d::UnitY()};
    if (weight_Nm > 0.0) {
      rig.mass_kg = weight_Nm / (kGravity_m_per_s2 * kArm_m);
      rig.arm_m = kArm_m;
    }
    robot_ = sample_hinge(rig);
    robot_.joints[0].servo = servo;
    robot_.joints[0].encoder.bits = 20;
    WorldOptions options;
    options.step_s = step_s;
    options.gravity_W_m_per_s2 = {0.0, 0.0, -kGravity_m_per_s2};
    options.ground.present = false;
    options.fixed_base = true;
    world_ = make_world(robot_, options);
    servo_.emplace(robot_.joints[0], ServoOptions{.step_s = step_s});
  }

  // One millisecond.
  void drive(double target_rad, double outer_Nm = 0.0) {
    servo_->sense(world_->joint(0));
    servo_->drive(static_cast<std::int32_t>(std::lround(target_rad / kRadPerPositionUnit)));
    advance(outer_Nm);
  }
  void release(double outer_Nm = 0.0) {
    servo_->sense(world_->joint(0));
    servo_->release();
    advance(outer_Nm);
  }

  JointState joint() const { return world_->joint(0); }
  const Servo& servo() const { return *servo_; }
  // In the last step.
  const ServoTorque& torque() const { return torque_; }
  // How often the gears have changed their edge.
  int edge_changes() const { return edge_changes_; }

 private:
  void advance(double outer_Nm) {
    for (long i = 0; i < steps_a_ms_; ++i) {
      const int edge = servo_->backlash().edge();
      servo_->draw(world_->joint(0));
      if (servo_->backlash().edge() != edge) ++edge_changes_;
      torque_ = servo_->torque(supply_V_);
      world_->set_servo(0, torque_);
      const double angle_rad = world_->joint(0).position_rad;
      world_->push(1, {kArm_m, 0.0, 0.0},
                   outer_Nm / kArm_m * Eigen::Vector3d(-std::sin(angle_rad), 0.0, std::cos(angle_rad)));
      world_->step();
    }
  }

  double supply_V_;
  long steps_a_ms_;
  RobotDescription robot_;
  std::unique_ptr<World> world_;
  std::optional<Servo> servo_;
  ServoTorque torque_;
  int edge_changes_ = 0;
};

}  // namespace koboshi::sim_board
