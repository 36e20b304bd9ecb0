#include "sim_board/engine/tree/tree_solver.h"

#include <algorithm>

namespace koboshi::sim {
namespace {

// Rows for which memory is allocated in advance: 30 contact points and the friction of all joints. For more,
// the memory is enlarged in the step that needs it.
constexpr std::size_t kUsualRows = 128;

std::size_t to_index(int number) { return static_cast<std::size_t>(number); }

}  // namespace

TreeSolver::TreeSolver(std::size_t bodies, std::span<const JointSpace::Joint> joints)
    : tree_(bodies, joints),
      reduced_(kUsualRows * tree_.dofs()),
      reduced_sum_(tree_.dofs()),
      body_impulses_(bodies, Vector6::Zero()),
      lcp_(kUsualRows) {
  rows_.reserve(kUsualRows);
  solutions_.reserve(kUsualRows);
  last_.reserve(kUsualRows);
}

bool TreeSolver::solve() {
  if (!tree_.factorise()) return false;
  tree_.solve();
  fill_problem();
  if (rows_.empty()) {
    solutions_.clear();
    return true;
  }
  if (!solve_rows()) return false;
  apply_impulses();
  return true;
}

void TreeSolver::fill_problem() {
  const std::size_t count = rows_.size();
  const auto dofs = static_cast<Eigen::Index>(tree_.dofs());
  lcp_.resize(count);
  if (reduced_.size() < count * tree_.dofs()) reduced_.resize(count * tree_.dofs());
  for (std::size_t r = 0; r < count; ++r) {
    const TreeRow& row = rows_[r];
    const std::span<double> y = reduced(r);
    std::ranges::fill(y, 0.0);
    double speed = row.jacobian.dot(tree_.velocity(to_index(row.body)));
    tree_.add_to_jacobian(to_index(row.body), row.jacobian, y);
    if (row.other_body >= 0) {
      speed += row.other_jacobian.dot(tree_.velocity(to_index(row.other_body)));
      tree_.add_to_jacobian(to_index(row.other_body), row.other_jacobian, y);
    }
    tree_.reduce(y);
    lcp_.b()[r] = row.target - speed;
    const std::span<double> A = lcp_.A();
    for (std::size_t s = 0; s <= r; ++s) {
      const double product =
          Eigen::VectorXd::Map(y.data(), dofs).dot(Eigen::VectorXd::Map(reduced(s).data(), dofs));
      A[r * count + s] = A[s * count + r] = product;
    }
    A[r * count + r] += row.softness;
  }
}

// The rows have nearly the same order as those of the last solution.
void TreeSolver::find_starts() {
  last_.swap(solutions_);
  solutions_.clear();
  auto next = last_.begin();
  for (const TreeRow& row : rows_) {
    const auto is_same = [&](const Solution& one) { return row.id != 0 && one.id == row.id; };
    auto found = std::find_if(next, last_.end(), is_same);
    if (found == last_.end()) found = std::find_if(last_.begin(), next, is_same);
    if (found != last_.end() && is_same(*found)) {
      solutions_.push_back(*found);
      next = found + 1;
    } else {
      solutions_.emplace_back().id = row.id;
    }
  }
}

bool TreeSolver::solve_from(Impulse Solution::*impulses) {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    lcp_.x()[r] = (solutions_[r].*impulses).x;
    lcp_.sides()[r] = (solutions_[r].*impulses).side;
  }
  if (!lcp_.solve()) return false;
  for (std::size_t r = 0; r < rows_.size(); ++r) solutions_[r].*impulses = {lcp_.x()[r], lcp_.sides()[r]};
  return true;
}

// Friction is bounded by the normal impulses in the absence of friction, as in ODE's solver.
bool TreeSolver::solve_rows() {
  find_starts();
  const std::span<BoxLcp::Bounds> bounds = lcp_.bounds();
  bool has_friction = false;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const bool is_friction = rows_[r].normal >= 0;
    bounds[r] = is_friction ? BoxLcp::Bounds{0.0, 0.0} : BoxLcp::Bounds{rows_[r].lower, rows_[r].upper};
    has_friction = has_friction || is_friction;
  }
  if (!solve_from(&Solution::frictionless)) return false;
  if (!has_friction) {
    for (Solution& solution : solutions_) solution.final = solution.frictionless;
    return true;
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (rows_[r].normal < 0) continue;
    const double limit = rows_[r].upper * std::max(lcp_.x()[to_index(rows_[r].normal)], 0.0);
    bounds[r] = {-limit, limit};
  }
  return solve_from(&Solution::final);
}

void TreeSolver::apply_impulses() {
  const auto dofs = static_cast<Eigen::Index>(tree_.dofs());
  auto sum = Eigen::VectorXd::Map(reduced_sum_.data(), dofs);
  sum.setZero();
  for (std::size_t r = 0; r < rows_.size(); ++r)
    sum += impulse(r) * Eigen::VectorXd::Map(reduced(r).data(), dofs);
  tree_.apply(reduced_sum_);
}

void TreeSolver::find_joint_impulses() {
  std::ranges::fill(body_impulses_, Vector6::Zero());
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const TreeRow& row = rows_[r];
    body_impulses_[to_index(row.body)] += impulse(r) * row.jacobian;
    if (row.other_body >= 0) body_impulses_[to_index(row.other_body)] += impulse(r) * row.other_jacobian;
  }
  tree_.find_joint_impulses(body_impulses_);
}

}  // namespace koboshi::sim
