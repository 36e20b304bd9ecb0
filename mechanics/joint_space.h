#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "mechanics/lanes.h"
#include "mechanics/spatial.h"

namespace koboshi::mechanics {

// Velocities of a tree of rigid bodies after one step, in joint coordinates: implicit in the servos' damping.
//
// The degrees of freedom (dofs) are six of the root and the axes of the joints. Dof i moves all bodies behind
// it by S_i for each unit of its speed u_i; joints may also impose velocities ("slips") on their children:
//   v_b = sum of S_i u_i over the dofs i between b and the root + c_b, where c_b is the sum of the slips.
// The impulse balance of the bodies, I_b v_b = g_b + joint impulses, with g_b the momentum before the step
// plus the external impulses, projected onto the dofs, gives
//   (H + damping) u = S' (g - I c) + drive.
// H_ij = S_i' I_i S_j, where I_i is the inertia of all bodies behind the dof i, and j is between i and the
// root (composite-rigid-body algorithm, Featherstone, table 6.2). H_ij is zero for dofs on different
// branches; the factorisation L'L preserves these zeros (Featherstone, sec. 6.5, tables 6.3 to 6.5).
class JointSpace {
 public:
  struct Joint {
    std::size_t parent = 0;
    std::size_t child = 0;
    std::size_t axes = 1;
  };

  struct Body {
    SpatialInertia inertia;
    Vector6 momentum = Vector6::Zero();  // before the step, plus the external impulses of the step
  };

  struct Axis {
    Vector6 motion = Vector6::Zero();  // S: velocity of the child relative to the parent at unit speed
    double damping = 0.0;              // impulse per unit of the new speed
    double drive = 0.0;                // impulse at speed zero
  };

  // Body 0 is the root. Each joint's parent is the root or the child of an earlier joint.
  JointSpace(std::size_t bodies, std::span<const Joint> joints);

  std::size_t bodies() const { return bodies_.size(); }
  std::size_t dofs() const { return axes_.size(); }
  // Dof of the joint's first axis; its other axes follow.
  std::size_t first_dof(std::size_t joint) const { return first_dofs_[joint]; }

  Body& body(std::size_t index) { return bodies_[index]; }
  Axis& axis(std::size_t dof) { return axes_[dof]; }
  // Velocity of the child relative to the parent that the joint imposes besides its axes.
  Vector6& slip(std::size_t joint) { return slips_[joint]; }
  // The root then does not move.
  void fix_root(bool fixed) { first_free_ = fixed ? kRootDofs : 0; }

  // Factorises H + damping. Must precede the functions below and follow each change of an inertia, a motion
  // or a damping. Returns false if the matrix is not positive definite.
  [[nodiscard]] bool factorise();
  // Solves for the speeds under the momenta, drives and slips alone.
  void solve();

  // Dofs that move the body, from the root on, in increasing order.
  std::span<const std::size_t> path(std::size_t body) const;

  // Rows of constraints. A row's Jacobian in joint coordinates is J; its reduced form is y = L'^-1 J', so
  // that the inverse inertia between two rows, J_r (H + damping)^-1 J_s', is the product of their reduced
  // forms. Four rows are treated at once, as the lanes of `J`, which has dofs() elements.
  //
  // Adds to J four impulses on a body, each for a unit of its row's impulse; `impulses` is by coordinate.
  void add_to_jacobian(std::size_t body, std::span<const Lanes, 6> impulses, std::span<Lanes> J) const;
  // `support` contains all dofs for which J is not zero and those between them and the root, in increasing
  // order.
  void reduce(std::span<const std::size_t> support, std::span<Lanes> J) const;
  // Adds the response to the impulses of rows, given as the sum of their reduced forms times their impulses.
  // Overwrites the argument.
  void apply(std::span<double> reduced_sum);

  double speed(std::size_t dof) const { return speeds_[dof]; }
  const Vector6& velocity(std::size_t body) const { return velocities_[body]; }

  // Computes the impulses through the joints for the present velocities, given those of the rows on each
  // body.
  void find_joint_impulses(std::span<const Vector6> row_impulses);
  // Impulse on the joint's child; includes drive and damping.
  const Vector6& joint_impulse(std::size_t joint) const { return flows_[joints_[joint].child]; }

 private:
  static constexpr std::size_t kRootDofs = 6;
  static constexpr int kNone = -1;
  static constexpr std::size_t kBlock = 4;  // elements of L_ that are combined at once

  const std::size_t* path_to(std::size_t dof) const { return &paths_[dof * dofs()]; }
  double* row(std::size_t dof) { return &L_[dof * stride_]; }
  const double* row(std::size_t dof) const { return &L_[dof * stride_]; }
  void make_paths(std::span<const int> before);
  void fill_matrix();
  bool factorise_rows();
  void solve_transposed(std::span<double> x) const;  // L' x = b in place
  void solve_lower(std::span<double> x) const;       // L x = b in place
  void update_velocities();

  std::vector<Joint> joints_;
  std::vector<Body> bodies_;
  std::vector<Axis> axes_;
  std::vector<Vector6> slips_;           // by joint
  std::vector<std::size_t> first_dofs_;  // by joint
  std::vector<int> last_dof_;            // by body: the last dof that moves it
  // By dof: the number of dofs between it and the root, and these dofs, from the root on, then itself.
  std::vector<std::size_t> depths_;
  std::vector<std::size_t> paths_;
  std::vector<std::size_t> moved_;        // by dof: the first body that it moves
  std::size_t first_free_ = 0;            // dof, and place in a path, which begins with the dofs of the root
  std::vector<SpatialInertia> inertias_;  // by body: of it and all bodies behind it
  // Row by row, with stride_ elements each: those for the dofs of its path, in the path's order. The path of
  // a dof begins with the path of each dof in it, so that rows are combined element by element.
  std::vector<double> L_;
  std::size_t stride_ = 0;
  std::vector<double> diagonal_inverse_;
  std::vector<double> speeds_;
  std::vector<Vector6> velocities_;  // by body
  std::vector<Vector6> flows_;       // by body: sum over the bodies behind it
};

}  // namespace koboshi::mechanics
