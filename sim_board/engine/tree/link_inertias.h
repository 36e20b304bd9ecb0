#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "mechanics/joint_space.h"
#include "mechanics/lanes.h"
#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// Inertias and momenta of a tree's bodies, each a rigid link, from their poses and velocities. Four bodies
// are computed at once.
//
// The momentum includes the impulses of gravity and of the gyroscopic torque, which is implicit as in ODE, so
// that it adds no energy. With the angular momentum L = I w,
//   tau = (I (I - h [L]x)^-1 - 1) L / h,
// which tends to L x w for h -> 0.
class LinkInertias {
 public:
  LinkInertias(std::size_t bodies, const Eigen::Vector3d& gravity_W_m_per_s2, double step_s);

  // Which link a body is. To be called once for each.
  void describe(std::size_t body, const LinkDescription& link);
  // Pose and velocity of a body, with its centre of mass at p_OCom_W.
  void set(std::size_t body, const Eigen::Matrix3d& R_WL, const Eigen::Vector3d& p_OCom_W,
           const Eigen::Vector3d& v_WCom_W, const Eigen::Vector3d& w_W);
  // Writes inertia and momentum of all bodies.
  void write(mechanics::JointSpace& tree);

 private:
  using Vector = std::array<mechanics::Lanes, 3>;
  using Matrix = std::array<std::array<mechanics::Lanes, 3>, 3>;  // by row
  // Four bodies.
  struct Group {
    Vector mass_kg{};  // three times the same
    Matrix I_L{};
    Matrix R_WL{};
    Vector p_OCom_W{};
    Vector v_WCom_W{};
    Vector w_W{};
    // Results:
    Vector moment_kg_m{};
    Matrix I_O{};
    Vector angular{};  // momentum about O
    Vector linear{};
  };

  void compute(Group& group) const;

  std::size_t bodies_;
  double step_s_;
  std::array<double, 3> falling_m_per_s_;  // gravity over a step
  std::vector<Group> groups_;
};

}  // namespace koboshi::sim_board
