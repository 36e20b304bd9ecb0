#include "lab/validate/rigs.h"

#include <cmath>
#include <string>

#include "base/text/error.h"
#include "sim_board/engine/make_world.h"
#include "simulation/scenario/reader.h"

namespace koboshi::lab {
namespace {

constexpr double kNoLimit_rad = 1e3;

sim_board::LinkDescription hanging_link(const HangingLink& rig, const Eigen::Vector3d& p_MJ,
                                        std::size_t number) {
  sim_board::LinkDescription link;
  link.name = "link " + std::to_string(number + 1);
  link.X_ML = Eigen::Translation3d(p_MJ);
  link.mass_kg = rig.mass_kg;
  link.p_LCom_L = {0.0, 0.0, -rig.arm_m};
  link.I_LCom_L = rig.inertia_kg_m2 * Eigen::Matrix3d::Identity();
  return link;
}

sim_board::JointDescription hinge(const Eigen::Vector3d& p_MJ, std::size_t number) {
  sim_board::JointDescription joint;
  joint.name = "hinge " + std::to_string(number + 1);
  joint.parent = static_cast<int>(number);
  joint.child = static_cast<int>(number) + 1;
  joint.p_MJ = p_MJ;
  joint.axis_M = Eigen::Vector3d::UnitY();
  joint.lower_rad = -kNoLimit_rad;
  joint.upper_rad = kNoLimit_rad;
  return joint;
}

}  // namespace

Eigen::Vector3d box_moments_kg_m2(double mass_kg, const Eigen::Vector3d& size_m) {
  const Eigen::Vector3d squares = size_m.cwiseAbs2();
  return mass_kg / 12.0 * (Eigen::Vector3d::Constant(squares.sum()) - squares);
}

sim_board::RobotDescription box_rig(double mass_kg, const Eigen::Vector3d& size_m,
                                    const sim_board::SurfaceDescription& surface) {
  sim_board::LinkDescription link;
  link.name = "box";
  link.mass_kg = mass_kg;
  link.I_LCom_L = box_moments_kg_m2(mass_kg, size_m).asDiagonal();
  sim_board::BoxDescription box;
  box.name = "box";
  box.size_m = size_m;
  box.surface = surface;
  link.collisions.push_back(box);
  sim_board::RobotDescription robot;
  robot.name = "box";
  robot.links.push_back(link);
  return robot;
}

sim_board::RobotDescription chain_rig(const std::vector<HangingLink>& links) {
  sim_board::RobotDescription robot;
  robot.name = "chain";
  sim_board::LinkDescription bearing;
  bearing.name = "bearing";
  bearing.mass_kg = 1.0;
  robot.links.push_back(bearing);
  Eigen::Vector3d p_MJ = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < links.size(); ++i) {
    robot.links.push_back(hanging_link(links[i], p_MJ, i));
    robot.joints.push_back(hinge(p_MJ, i));
    p_MJ.z() -= links[i].length_m;
  }
  return robot;
}

std::unique_ptr<sim_board::World> hang(const sim_board::RobotDescription& chain,
                                       const std::vector<double>& positions_rad,
                                       const ValidationSetup& setup) {
  sim_board::WorldOptions options = setup.world;
  options.ground.present = false;
  options.fixed_base = true;
  options.joint_positions_rad = positions_rad;
  return sim_board::make_world(chain, options);
}

long steps_of(double duration_s, const sim_board::World& world) {
  return std::lround(duration_s / world.step_s());
}

void run_for(sim_board::World& world, double duration_s) {
  const long steps = steps_of(duration_s, world);
  for (long i = 0; i < steps; ++i) world.step();
}

simulation::Scenario squat_scenario(const ValidationSetup& setup) {
  simulation::Scenario scenario = simulation::read_scenario(setup.scenario, {});
  if (scenario.motions.empty()) {
    throw InputError(setup.scenario, 0, "no motion", "the scenario of squats");
  }
  scenario.initial.release_us = 1'400'000;
  scenario.commands = {{.at_us = 700'000, .kind = simulation::Command::Kind::kEnable},
                       {.at_us = 1'500'000, .kind = simulation::Command::Kind::kPlay, .motion = 0}};
  scenario.physics = {.step_us = static_cast<std::uint64_t>(std::llround(1e6 * setup.world.step_s)),
                      .stepper = setup.world.stepper};
  return scenario;
}

}  // namespace koboshi::lab
