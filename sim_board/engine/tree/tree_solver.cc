#include "sim_board/engine/tree/tree_solver.h"

#include <algorithm>

namespace koboshi::sim_board {
namespace {

// Rows for which memory is allocated in advance: 30 contact points and the friction of all joints. For more,
// the memory is enlarged in the step that needs it.
constexpr std::size_t kUsualRows = 128;

// Solutions of a step before the friction is left as it is, and the error that is taken for a solution, as a
// share of the largest normal impulse.
constexpr int kMaxTreeSolutions = 40;
constexpr double kTolerance = 1e-5;

// Solutions of a step whose normal impulses are taken as they are. Most steps need fewer. Then the guesses
// are relaxed, because where friction unloads the point that it acts on, they would alternate forever.
constexpr int kPlainSolutions = 3;
// Limits of the share of the change that a relaxed guess takes.
constexpr double kMinRelaxation = 0.02;
constexpr double kMaxRelaxation = 1.0;

std::size_t to_index(int number) { return static_cast<std::size_t>(number); }

double dot(const double* one, const double* other, std::size_t size) {
  const auto length = static_cast<Eigen::Index>(size);
  return Eigen::VectorXd::Map(one, length).dot(Eigen::VectorXd::Map(other, length));
}

}  // namespace

TreeSolver::TreeSolver(std::size_t bodies, std::span<const mechanics::JointSpace::Joint> joints)
    : tree_(bodies, joints),
      reduced_(kUsualRows * tree_.dofs()),
      reduced_sum_(tree_.dofs()),
      body_impulses_(bodies, mechanics::Vector6::Zero()),
      lcp_(kUsualRows) {
  rows_.reserve(kUsualRows);
  frictions_.reserve(kUsualRows);
  friction_rows_.reserve(kUsualRows);
  normals_.reserve(kUsualRows);
  normal_changes_.reserve(kUsualRows);
  A_.resize(kUsualRows * kUsualRows);
  b_.resize(kUsualRows);
  impulses_.resize(kUsualRows);
  solutions_.reserve(kUsualRows);
  last_.reserve(kUsualRows);
}

bool TreeSolver::solve() {
  if (!tree_.factorise()) return false;
  tree_.solve();
  fill_problem();
  if (rows_.empty()) {
    solutions_.clear();
    settled_ = true;
    return true;
  }
  if (!solve_rows()) return false;
  apply_impulses();
  return true;
}

void TreeSolver::fill_problem() {
  const std::size_t count = rows_.size();
  const auto dofs = static_cast<Eigen::Index>(tree_.dofs());
  if (reduced_.size() < count * tree_.dofs()) reduced_.resize(count * tree_.dofs());
  if (A_.size() < count * count) A_.resize(count * count);
  for (auto* vector : {&b_, &impulses_})
    if (vector->size() < count) vector->resize(count);
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
    b_[r] = row.target - speed;
    for (std::size_t s = 0; s <= r; ++s) {
      const double product =
          Eigen::VectorXd::Map(y.data(), dofs).dot(Eigen::VectorXd::Map(reduced(s).data(), dofs));
      A_[r * count + s] = A_[s * count + r] = product;
    }
    A_[r * count + r] += row.softness;
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

bool TreeSolver::solve_rows() {
  find_starts();
  lcp_.resize(rows_.size());
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    lcp_.sides()[r] = solutions_[r].side;
    impulses_[r] = solutions_[r].x;
  }
  settled_ = false;
  for (int solution = 0; solution < kMaxTreeSolutions && !settled_; ++solution) {
    write_problem();
    if (!lcp_.solve()) return false;
    read_impulses();
    settled_ = frictions_.empty() || improve_guesses() <= kTolerance;
    if (!settled_) relax_guesses(solution);
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    solutions_[r].x = impulses_[r];
    solutions_[r].side = lcp_.sides()[r];
  }
  return true;
}

// Aitken's relaxation of the normal impulses (U. Kuettler and W. A. Wall, "Fixed-point fluid-structure
// interaction solvers with dynamic relaxation", 2008, equation 44). If the changes are linear in one mode,
// the guess after two solutions is exact.
void TreeSolver::relax_guesses(int solution) {
  const std::size_t count = frictions_.size();
  normal_changes_.resize(count);
  double product = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double change = frictions_[i].guess.normal - normals_[i];
    const double difference = change - normal_changes_[i];
    product += normal_changes_[i] * difference;
    square += difference * difference;
    normal_changes_[i] = change;
  }
  if (solution < kPlainSolutions || square == 0.0) {
    relaxation_ = 1.0;
    return;
  }
  relaxation_ = std::clamp(-relaxation_ * product / square, kMinRelaxation, kMaxRelaxation);
  for (std::size_t i = 0; i < count; ++i)
    frictions_[i].guess.normal = normals_[i] + relaxation_ * normal_changes_[i];
}

void TreeSolver::write_problem() {
  const std::size_t count = rows_.size();
  lcp_.resize(count);
  std::copy_n(A_.begin(), count * count, lcp_.A().begin());
  std::copy_n(b_.begin(), count, lcp_.b().begin());
  std::copy_n(impulses_.begin(), count, lcp_.x().begin());
  for (std::size_t r = 0; r < count; ++r) lcp_.bounds()[r] = {rows_[r].lower, rows_[r].upper};
  friction_rows_.clear();
  normals_.clear();
  for (const TreeFriction& friction : frictions_) {
    normals_.push_back(friction.guess.normal);
    friction_rows_.push_back(friction_rows(friction.law, friction.guess));
    const FrictionRows& rows = friction_rows_.back();
    for (std::size_t i = 0; i < friction.rows(); ++i)
      lcp_.bounds()[friction.row(i)] = {-rows.bounds[i], rows.bounds[i]};
    if (friction.law.is_planar()) turn_rows(friction, rows);
  }
}

void TreeSolver::turn_rows(const TreeFriction& friction, const FrictionRows& rows) {
  const std::size_t count = rows_.size();
  const std::size_t one = friction.row(0);
  const std::size_t two = friction.row(1);
  const auto turn = [&](double& x, double& y) {
    const Eigen::Vector2d vector(x, y);
    x = rows.first.dot(vector);
    y = rows.second().dot(vector);
  };
  const std::span<double> A = lcp_.A();
  for (std::size_t r = 0; r < count; ++r) turn(A[one * count + r], A[two * count + r]);
  for (std::size_t r = 0; r < count; ++r) turn(A[r * count + one], A[r * count + two]);
  turn(lcp_.b()[one], lcp_.b()[two]);
  turn(lcp_.x()[one], lcp_.x()[two]);
  A[two * count + two] += rows.softness;
  lcp_.b()[two] += rows.target();
}

void TreeSolver::read_impulses() {
  std::ranges::copy(lcp_.x(), impulses_.begin());
  for (std::size_t i = 0; i < frictions_.size(); ++i) {
    if (!frictions_[i].law.is_planar()) continue;
    const FrictionRows& rows = friction_rows_[i];
    double& x = impulses_[frictions_[i].row(0)];
    double& y = impulses_[frictions_[i].row(1)];
    const Eigen::Vector2d impulse = x * rows.first + y * rows.second();
    x = impulse.x();
    y = impulse.y();
  }
}

double TreeSolver::improve_guesses() {
  const std::size_t count = rows_.size();
  FrictionSearch search;
  for (TreeFriction& friction : frictions_) {
    FrictionSolution solution{.normal = impulses_[friction.normal_row]};
    double inverse_mass = 0.0;
    for (std::size_t i = 0; i < friction.rows(); ++i) {
      const std::size_t row = friction.row(i);
      const auto axis = static_cast<Eigen::Index>(i);
      solution.friction[axis] = impulses_[row];
      solution.velocity[axis] = dot(&A_[row * count], impulses_.data(), count) - b_[row];
      inverse_mass += A_[row * count + row] / static_cast<double>(friction.rows());
    }
    search.improve(friction.law, solution, 1.0 / inverse_mass, friction.guess);
  }
  return search.error();
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
  std::ranges::fill(body_impulses_, mechanics::Vector6::Zero());
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const TreeRow& row = rows_[r];
    body_impulses_[to_index(row.body)] += impulse(r) * row.jacobian;
    if (row.other_body >= 0) body_impulses_[to_index(row.other_body)] += impulse(r) * row.other_jacobian;
  }
  tree_.find_joint_impulses(body_impulses_);
}

}  // namespace koboshi::sim_board
