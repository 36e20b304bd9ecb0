#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sim_board/engine/tree/box_lcp.h"
#include "sim_board/engine/tree/joint_space.h"
#include "sim_board/engine/tree/spatial.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim {

// A scalar constraint on the velocities after the step, with a bounded impulse x along it:
//   jacobian . v_body + other_jacobian . v_other + softness x = target,  lower <= x <= upper,
// where the equation becomes an inequality if x is at a bound. other_body = -1: the world.
struct TreeRow {
  int body = 0;
  int other_body = -1;
  Vector6 jacobian = Vector6::Zero();
  Vector6 other_jacobian = Vector6::Zero();
  double target = 0.0;    // m/s or rad/s
  double softness = 0.0;  // per unit of impulse: 1/kg or 1/(kg m^2)
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  // For a friction row, the index of the row of its normal: `upper` is then the coefficient of friction times
  // the impulse of that row in the absence of friction, and `lower` its opposite. Otherwise -1.
  int normal = -1;
  // Identifies the row among those of the last solution, where the search for its impulse starts; 0: none.
  std::uint64_t id = 0;

  // Speed along the row at these velocities of the bodies.
  double speed(std::span<const Vector6> velocities) const {
    const double own = jacobian.dot(velocities[static_cast<std::size_t>(body)]);
    if (other_body < 0) return own;
    return own + other_jacobian.dot(velocities[static_cast<std::size_t>(other_body)]);
  }
};

// Solves one step of a tree of bodies with constraints (contacts, stops). The tree is eliminated, which
// leaves a small dense problem in the rows:
//   A = J (H + damping)^-1 J' + softness,  b = target - J v_free,
// where v_free are the velocities without the rows.
class TreeSolver {
 public:
  TreeSolver(std::size_t bodies, std::span<const JointSpace::Joint> joints);

  JointSpace& tree() { return tree_; }
  const JointSpace& tree() const { return tree_; }
  // Rows of the next solution.
  std::vector<TreeRow>& rows() { return rows_; }
  const TreeRow& row(std::size_t index) const { return rows_[index]; }

  // Computes velocities and impulses. Returns false if it finds no solution within rounding.
  [[nodiscard]] bool solve();
  double impulse(std::size_t row) const { return lcp_.x()[row]; }
  // Computes the impulses through the joints.
  void find_joint_impulses();

  void archive(StateArchive& archive) { archive(solutions_); }

 private:
  struct Impulse {
    double x = 0.0;
    BoxLcp::Side side = BoxLcp::Side::kFree;
  };
  struct Solution {
    std::uint64_t id = 0;
    Impulse frictionless;  // in the absence of contact friction
    Impulse final;
  };

  std::span<double> reduced(std::size_t row) { return {&reduced_[row * tree_.dofs()], tree_.dofs()}; }
  void fill_problem();
  void find_starts();
  bool solve_rows();
  // Solves from these impulses of each row, and writes the solution to them.
  bool solve_from(Impulse Solution::*impulses);
  void apply_impulses();

  JointSpace tree_;
  std::vector<TreeRow> rows_;
  std::vector<double> reduced_;         // by row: reduced Jacobian
  std::vector<double> reduced_sum_;     // by dof
  std::vector<Vector6> body_impulses_;  // by body
  std::vector<Solution> solutions_;     // by row
  std::vector<Solution> last_;          // of the last call
  BoxLcp lcp_;
};

}  // namespace koboshi::sim
