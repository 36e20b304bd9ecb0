#include <algorithm>
#include <cmath>

#include "lab/validate/rigs.h"
#include "lab/validate/validation.h"
#include "sim_board/engine/make_world.h"
#include "sim_board/world/ground_truth.h"

namespace koboshi::lab {
namespace {

using Eigen::Vector3d;

constexpr HangingLink kChainLink{.mass_kg = 0.1, .inertia_kg_m2 = 2e-4, .arm_m = 0.06, .length_m = 0.12};
constexpr double kTorque_Nm = 0.02;

// About the common centre of mass.
Vector3d angular_momentum_Nm_s(const sim_board::RobotDescription& robot, const sim_board::World& world) {
  const sim_board::CentreOfMass com = sim_board::centre_of_mass(robot, world);
  Vector3d sum = Vector3d::Zero();
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    const sim_board::LinkDescription& link = robot.links[l];
    const sim_board::BodyState body = world.body(static_cast<int>(l));
    const Eigen::Matrix3d& R = body.X_WL.linear();
    sum += link.mass_kg * (body.X_WL * link.p_LCom_L - com.p_WCom_W).cross(body.v_WCom_W - com.v_WCom_W) +
           R * (link.I_LCom_L * (R.transpose() * body.w_WL_W));
  }
  return sum;
}

Findings run_momentum(const ValidationSetup& setup) {
  sim_board::RobotDescription robot = chain_rig({kChainLink, kChainLink, kChainLink});
  robot.links[0].mass_kg = 0.3;
  robot.links[0].I_LCom_L = 4e-4 * Eigen::Matrix3d::Identity();
  sim_board::WorldOptions options = setup.world;
  options.ground.present = false;
  const auto world = sim_board::make_world(robot, options);
  const Vector3d start_m = sim_board::centre_of_mass(robot, *world).p_WCom_W;
  constexpr double kDuration_s = 1.0;
  double spin = 0.0, energy_J = 0.0;
  for (long i = steps_of(kDuration_s, *world); i > 0; --i) {
    for (int j = 0; j < 3; ++j) {
      const double torque_Nm = kTorque_Nm * std::sin((j + 2) * 4.0 * world->time_s());
      world->set_servo(j, {.drive_Nm = torque_Nm, .damping_Nm_s = 2e-4, .rotor_inertia_kg_m2 = 1e-4});
    }
    world->step();
    spin = std::max(spin, angular_momentum_Nm_s(robot, *world).norm());
    double moving_J = 0.0;
    const Vector3d v = sim_board::centre_of_mass(robot, *world).v_WCom_W;
    for (std::size_t l = 0; l < robot.links.size(); ++l) {
      const sim_board::LinkDescription& link = robot.links[l];
      const sim_board::BodyState body = world->body(static_cast<int>(l));
      moving_J += 0.5 * link.mass_kg * (body.v_WCom_W - v).squaredNorm() +
                  0.5 * link.I_LCom_L(1, 1) * body.w_WL_W.squaredNorm();
    }
    energy_J = std::max(energy_J, moving_J);
  }
  const sim_board::CentreOfMass end = sim_board::centre_of_mass(robot, *world);
  const double fall_m = 0.5 * kGravity_m_per_s2 * kDuration_s * (kDuration_s + setup.world.step_s);
  return {
      .checks = {
          {"speed of the centre of mass after 1 s", "m/s", -kGravity_m_per_s2 * kDuration_s, end.v_WCom_W.z(),
           1e-9},
          {"way of the centre of mass aside", "m", 0.0, (end.p_WCom_W - start_m).head<2>().norm(), 1e-9},
          {"fall of the centre of mass", "m", -0.5 * kGravity_m_per_s2 * kDuration_s * kDuration_s,
           (end.p_WCom_W - start_m).z(), fall_m - 0.5 * kGravity_m_per_s2 * kDuration_s * kDuration_s + 1e-9},
          {"angular momentum of the whole", "N m s", 0.0, spin, setup.world.step_s * energy_J}}};
}

}  // namespace

Validation momentum() {
  return {.name = "momentum",
          .title = "Momentum in free flight",
          .theory =
              "Four links on three hinges, with motors of 0.02 N m, rotors and grease, fall without ground: "
              "whatever the joints do is internal, so that the centre of mass falls as a point does and the "
              "angular momentum about it stays zero.",
          .tolerances =
              "Linear momentum: round-off, for the engine's joint forces are equal and opposite. Angular: "
              "first order, h times the largest kinetic energy about the centre of mass.",
          .run = run_momentum};
}

}  // namespace koboshi::lab
