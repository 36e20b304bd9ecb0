#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mechanics/box_lcp.h"
#include "mechanics/joint_space.h"
#include "mechanics/lanes.h"
#include "mechanics/spatial.h"
#include "sim_board/engine/common/friction.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim_board {

// A scalar constraint on the velocities after the step, with a bounded impulse x along it:
//   jacobian . v_body + other_jacobian . v_other + softness x = target,  lower <= x <= upper,
// where the equation becomes an inequality if x is at a bound. other_body = -1: the world.
struct TreeRow {
  int body = 0;
  int other_body = -1;
  mechanics::Vector6 jacobian = mechanics::Vector6::Zero();
  mechanics::Vector6 other_jacobian = mechanics::Vector6::Zero();
  double target = 0.0;    // m/s or rad/s
  double softness = 0.0;  // per unit of impulse: 1/kg or 1/(kg m^2)
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  // Identifies the row among those of the last solution, where the search for its impulse starts; 0: none.
  std::uint64_t id = 0;

  // Speed along the row at these velocities of the bodies.
  double speed(std::span<const mechanics::Vector6> velocities) const {
    const double own = jacobian.dot(velocities[static_cast<std::size_t>(body)]);
    if (other_body < 0) return own;
    return own + other_jacobian.dot(velocities[static_cast<std::size_t>(other_body)]);
  }
};

// A further body in a row: its Jacobian counts like those of the row's own bodies.
struct TreeTerm {
  std::size_t row = 0;
  int body = 0;
  mechanics::Vector6 jacobian = mechanics::Vector6::Zero();
};

// Friction of a contact point. Its rows, one or two as the law has directions, follow the row of the normal;
// the solver bounds them.
struct TreeFriction {
  std::size_t normal_row = 0;
  FrictionLaw law;
  FrictionGuess guess;  // where the search starts; impulses

  std::size_t rows() const { return law.is_planar() ? 2 : 1; }
  std::size_t row(std::size_t direction) const { return normal_row + 1 + direction; }
};

// Solves one step of a tree of bodies with constraints (contacts, stops). The tree is eliminated, which
// leaves a small dense problem in the rows:
//   A = J (H + damping)^-1 J' + softness,  b = target - J v_free,
// where v_free are the velocities without the rows. With friction, the problem is solved again, each time
// with the guesses that follow from the last solution, until all contact points obey the law of friction.
class TreeSolver {
 public:
  TreeSolver(std::size_t bodies, std::span<const mechanics::JointSpace::Joint> joints);

  mechanics::JointSpace& tree() { return tree_; }
  const mechanics::JointSpace& tree() const { return tree_; }
  // Rows of the next solution.
  std::vector<TreeRow>& rows() { return rows_; }
  const TreeRow& row(std::size_t index) const { return rows_[index]; }
  // Further bodies of these rows.
  std::vector<TreeTerm>& terms() { return terms_; }
  // Friction of the next solution, in the order of its rows.
  std::vector<TreeFriction>& frictions() { return frictions_; }
  std::span<const TreeFriction> frictions() const { return frictions_; }

  // Computes velocities and impulses. Returns false if it finds no solution within rounding.
  [[nodiscard]] bool solve();
  double impulse(std::size_t row) const { return impulses_[row]; }
  // Returns whether the last solution obeys the law of friction.
  bool settled() const { return settled_; }
  // Computes the impulses through the joints.
  void find_joint_impulses();

  void archive(StateArchive& archive) { archive(solutions_); }

 private:
  struct Solution {
    std::uint64_t id = 0;
    double x = 0.0;
    mechanics::BoxLcp::Side side = mechanics::BoxLcp::Side::kFree;
  };

  // Dofs at which the reduced forms of rows are not zero.
  struct Support {
    explicit Support(std::span<const std::size_t> in_order, std::size_t all);

    static constexpr std::size_t kSums = 7;
    std::span<const std::size_t> dofs;      // in increasing order
    std::vector<std::size_t> by_sum;        // the same by the sum of a product that they belong to
    std::array<std::size_t, kSums> ends{};  // in by_sum, of each sum
  };
  // Consecutive rows that act on the same bodies, at most as many as there are lanes.
  struct RowGroup {
    std::size_t first = 0;
    std::size_t rows = 0;
    const Support* support = nullptr;
  };

  std::span<mechanics::Lanes> reduced(std::size_t group) {
    return {&reduced_[group * tree_.dofs()], tree_.dofs()};
  }
  void fill_problem();
  bool has_terms(std::size_t row) const;
  void make_groups();
  const Support& support(const TreeRow& row) const;
  void reduce_group(std::size_t number);
  // Writes the products of one group's reduced forms with those of another.
  void multiply_groups(std::size_t number, std::size_t other_number);
  void find_starts();
  bool solve_rows();
  // Writes the problem for the present guesses of friction, whose rows it turns.
  void write_problem();
  void turn_rows(const TreeFriction& friction, const FrictionRows& rows);
  void read_impulses();
  // Improves the guesses. Returns the largest error of a contact point relative to the largest normal
  // impulse.
  double improve_guesses();
  void relax_guesses(int solution);
  void apply_impulses();

  mechanics::JointSpace tree_;
  std::vector<TreeRow> rows_;
  std::vector<TreeTerm> terms_;
  std::vector<RowGroup> groups_;
  std::vector<mechanics::Lanes> reduced_;  // by group: reduced Jacobians of its rows, by dof
  std::vector<std::size_t> all_dofs_;
  std::vector<Support> supports_;                  // by body, then of all dofs
  std::vector<double> reduced_sum_;                // by dof
  std::vector<mechanics::Vector6> body_impulses_;  // by body
  std::vector<TreeFriction> frictions_;
  std::vector<FrictionRows> friction_rows_;  // of the present solution
  std::vector<double> normals_;              // guesses of the present solution, by friction
  std::vector<double> normal_changes_;       // to the normals that the last solution found
  double relaxation_ = 1.0;
  std::vector<double> A_;  // as in lcp_, but with rows that are not turned
  std::vector<double> b_;
  std::vector<double> impulses_;
  bool settled_ = true;
  std::vector<Solution> solutions_;  // by row
  std::vector<Solution> last_;       // of the last call
  mechanics::BoxLcp lcp_;
};

}  // namespace koboshi::sim_board
