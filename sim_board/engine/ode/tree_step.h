#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim_board/engine/ode/bodies.h"
#include "sim_board/engine/ode/collider.h"
#include "sim_board/engine/ode/joint_chain.h"
#include "sim_board/engine/ode/soles.h"
#include "sim_board/engine/tree/link_inertias.h"
#include "sim_board/engine/tree/tree_solver.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim_board {

// One step of ODE's bodies with the tree's solver in place of ODE's: the same equations of motion, contacts
// and servos, and the same integration. The robot's joints are eliminated instead of being rows of a dense
// matrix, whose factorisation takes time with the third power of their number. The result differs by the
// compliance of ODE's joints (its default CFM, 1e-10) and by rounding.
//
// The tree's bodies are those of ODE, each without the links that it carries, and then these links, which lie
// between the hinges of a chain: they cost no degree of freedom.
class TreeStep {
 public:
  // A hinge of a chain.
  struct Place {
    std::size_t chain = 0;
    std::size_t hinge = 0;
  };
  // A hinge that follows another one, as a row between the four bodies of both:
  //   speed - multiplier * leader's speed = -error reduction / step * error of the position
  struct Coupling {
    Place follower;
    Place leader;
    double multiplier = 1.0;
    double offset_rad = 0.0;
  };

  // `bodies` must outlive this object.
  TreeStep(const RobotDescription& robot, const Bodies& bodies, std::span<const JointChain> chains,
           std::span<const Coupling> couplings, const Eigen::Vector3d& gravity_W_m_per_s2, double step_s);

  // Reads the bodies before the step: poses, velocities and accumulated forces.
  void begin(std::span<const JointChain> chains);
  // Solves for the present guesses of the chains and soles. Writes the new velocities to the bodies and the
  // torques to the chains, so that the guesses can be checked. Returns false, and leaves the bodies
  // unchanged, if the solver finds no solution.
  [[nodiscard]] bool solve(std::span<JointChain> chains, Collider& collider, Soles& soles);
  // After the accepted solution: moves the bodies, clears their forces and reads the forces of the joints.
  void finish(std::span<JointChain> chains);

  const TreeSolver& solver() const { return solver_; }

  void archive(StateArchive& archive);

 private:
  struct Velocity {
    Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d w_W = Eigen::Vector3d::Zero();
  };

  void read_body(std::size_t index);
  void add_forces(std::size_t index);
  void add_coupling(const Coupling& coupling, std::span<JointChain> chains);
  void write_velocities();
  void restore_velocities();

  const Bodies& bodies_;
  const double step_s_;
  // By chain: its first joint, and the tree's body of the first link between its hinges.
  struct Start {
    std::size_t joint = 0;
    std::size_t between = 0;
  };
  std::vector<Start> places_;
  std::vector<Coupling> couplings_;
  TreeSolver solver_;
  LinkInertias inertias_;
  // Values at the beginning of the step:
  Eigen::Vector3d p_WO_W_ = Eigen::Vector3d::Zero();  // the tree's origin: the base's centre of mass
  std::vector<Velocity> velocities_;
};

}  // namespace koboshi::sim_board
