#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "sim_board/engine/tree/tree_solver.h"

namespace koboshi::sim_board {

// A contact point of a foot with the ground.
struct SolePoint {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  double depth_m = 0.0;  // penetration
};

// Contact of one flat foot that stands still on the ground, solved as a whole instead of point by point.
//
// Why: each contact point has three bounded rows: the normal force must not pull, and friction is limited.
// The rows of several points are redundant, and the solver searches for those at their bounds. For a flat
// foot at rest no row is at its bound, and six rows describe the contact of the rigid foot completely. This
// class provides these six rows without bounds: one factorisation, no search.
//
// When: the foot has rested on three or more points for some steps (class Soles decides, and leaves out the
// rows of the points meanwhile). After the solution is_possible() checks the bounds that the rows lack. If
// one is violated, Soles releases the foot and the step is solved again with the rows of the points.
//
// Model: all n points have the same spring and damper along the normal, f_i = (ERP depth_i / h - v_i) / CFM
// with step size h. With x and y along the principal axes of the points, about their mean, the sum of these
// forces and their moments decouple into three rows:
//   translation along the normal   CFM / n,
//   rotation about x, about y      CFM / sum y_i^2, CFM / sum x_i^2.
// The other three rows (translation along x and y, rotation about the normal) are rigid: static friction.
class HeldSole {
 public:
  static constexpr std::size_t kMaxSolePoints = 16;

  // `body` is the index of `ode_body` in the tree. Initially nothing is held.
  HeldSole(dBodyID ode_body, int body);

  // Holds the foot until let_go(). `points` are three to kMaxSolePoints, not collinear; `n_W` is their common
  // normal, out of the ground; ERP and CFM are those of one point at this step size.
  void hold(std::span<const SolePoint> points, const Eigen::Vector3d& n_W, double error_reduction,
            double force_mixing, double step_s);
  void let_go() { holding_ = false; }
  bool holds() const { return holding_; }
  // Appends the six rows. `p_WO_W` is the origin of the tree's spatial vectors.
  void add_rows(std::vector<TreeRow>& rows, const Eigen::Vector3d& p_WO_W);

  // Returns, after a solution, whether contact points could exert the forces of the six rows: no point pulls,
  // and friction at each is within Coulomb's limit. Tangential force and moment about the centre of pressure
  // are shared among the points in proportion to their normal forces (the moment also to the distance). The
  // condition is therefore sufficient, not necessary: another distribution might satisfy the limits.
  bool is_possible(const TreeSolver& solver, double friction);
  // Force on the body at each point in N, as computed by is_possible().
  std::span<const Eigen::Vector3d> forces_W() const { return forces_W_; }

 private:
  void find_axes(const Eigen::Vector3d& n_W);
  void find_springs();

  dBodyID ode_body_;
  int body_;
  bool holding_ = false;

  // State of the last hold():
  std::vector<SolePoint> points_;
  std::vector<Eigen::Vector3d> forces_W_;
  std::array<Eigen::Vector3d, 3> axes_W_;                // normal, then principal axes of the points
  Eigen::Vector3d p_WMean_W_ = Eigen::Vector3d::Zero();  // of the points
  double restoring_per_s_ = 0.0;                         // ERP / h
  double force_mixing_ = 0.0;                            // of one point
  double step_s_ = 0.0;
  // Sums over the points, with x and y along the principal axes: of depth, x^2, y^2, x depth, y depth.
  double depth_m_ = 0.0;
  double xx_m2_ = 0.0;
  double yy_m2_ = 0.0;
  double x_depth_m2_ = 0.0;
  double y_depth_m2_ = 0.0;
  std::size_t first_row_ = 0;
};

}  // namespace koboshi::sim_board
