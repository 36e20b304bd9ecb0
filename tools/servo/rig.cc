#include "tools/servo/rig.h"

#include <cmath>

#include "sim_board/engine/make_world.h"
#include "sim_board/world/gravity.h"

namespace koboshi::tools {
namespace {

using sim_board::kGravity_m_per_s2;

constexpr double kArm_m = 0.1;

// An arm along x that turns about -y: a positive angle lifts it.
sim_board::RobotDescription bench(const sim_board::ServoDescription& servo, const RigLoad& load) {
  sim_board::RobotDescription robot;
  robot.name = "bench";
  sim_board::LinkDescription link;
  link.name = "case";
  link.mass_kg = 1.0;
  robot.links.push_back(link);
  link.name = "arm";
  const double mass_kg = load.weight_Nm / (kGravity_m_per_s2 * kArm_m);
  link.mass_kg = mass_kg > 0.0 ? mass_kg : 0.01;
  link.p_LCom_L = {mass_kg > 0.0 ? kArm_m : 0.0, 0.0, 0.0};
  link.I_LCom_L = load.inertia_kg_m2 * Eigen::Matrix3d::Identity();
  robot.links.push_back(link);
  sim_board::JointDescription joint;
  joint.name = "shaft";
  joint.parent = 0;
  joint.child = 1;
  joint.axis_M = -Eigen::Vector3d::UnitY();
  joint.lower_rad = -1e4;  // no stops
  joint.upper_rad = 1e4;
  joint.servo = servo;
  robot.joints.push_back(joint);
  return robot;
}

sim_board::WorldOptions bench_options() {
  sim_board::WorldOptions options;
  options.step_s = ServoRig::kStep_s;
  options.gravity_W_m_per_s2 = {0.0, 0.0, -kGravity_m_per_s2};
  options.ground.present = false;
  options.fixed_base = true;
  return options;
}

}  // namespace

ServoRig::ServoRig(const sim_board::ServoDescription& servo, const RigLoad& load)
    : supply_V_(servo.supply_V),
      robot_(bench(servo, load)),
      world_(sim_board::make_world(robot_, bench_options())),
      servo_(robot_.joints[0], {.step_s = kStep_s}) {}

void ServoRig::drive_to(double target_rad, double outer_Nm) {
  advance(static_cast<std::int32_t>(std::lround(target_rad / sim_board::kRadPerPositionUnit)), outer_Nm);
}

void ServoRig::drive_fully(double outer_Nm) {
  constexpr std::int32_t kTurn = 1 << sim_board::kPositionBits;
  advance(servo_.position_units() + 100 * kTurn, outer_Nm);
}

void ServoRig::advance(std::int32_t target_units, double outer_Nm) {
  servo_.sense(world_->joint(0));
  servo_.drive(target_units);
  const auto steps = std::lround(sim_board::PositionController::kPeriod_s / kStep_s);
  for (long i = 0; i < steps; ++i) {
    servo_.draw(world_->joint(0));
    world_->set_servo(0, servo_.torque(supply_V_));
    // The arm's tip moves on a circle about y: a force across the arm is a pure torque about the shaft.
    const double angle_rad = world_->joint(0).position_rad;
    const Eigen::Vector3d across_W(-std::sin(angle_rad), 0.0, std::cos(angle_rad));
    world_->push(1, {kArm_m, 0.0, 0.0}, outer_Nm / kArm_m * across_W);
    world_->step();
  }
}

}  // namespace koboshi::tools
