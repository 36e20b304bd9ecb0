#include "sim_board/engine/tree/tree_solver.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "mechanics/vector_clones.h"

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

// A product is summed in the order of Eigen's dot product in registers of two numbers: elements 0, 4, 8, ...,
// those from 1, 2 and 3 on alike, and what remains, at most three elements, by itself.
TreeSolver::Support::Support(std::span<const std::size_t> in_order, std::size_t all) : dofs(in_order) {
  const std::size_t blocks_end = all / 4 * 4;
  const std::size_t pairs_end = all / 2 * 2;
  for (std::size_t sum = 0; sum < kSums; ++sum) {
    for (const std::size_t dof : dofs)
      if ((dof < blocks_end ? dof % 4 : dof < pairs_end ? 4 + dof % 2 : 6) == sum) by_sum.push_back(dof);
    ends[sum] = by_sum.size();
  }
}

TreeSolver::TreeSolver(std::size_t bodies, std::span<const mechanics::JointSpace::Joint> joints)
    : tree_(bodies, joints),
      reduced_(kUsualRows * tree_.dofs()),
      all_dofs_(tree_.dofs()),
      reduced_sum_(tree_.dofs()),
      body_impulses_(bodies, mechanics::Vector6::Zero()),
      lcp_(kUsualRows) {
  std::iota(all_dofs_.begin(), all_dofs_.end(), std::size_t{0});
  for (std::size_t b = 0; b < bodies; ++b) supports_.emplace_back(tree_.path(b), tree_.dofs());
  supports_.emplace_back(all_dofs_, tree_.dofs());
  groups_.reserve(kUsualRows);
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
  if (A_.size() < count * count) A_.resize(count * count);
  for (auto* vector : {&b_, &impulses_})
    if (vector->size() < count) vector->resize(count);
  make_groups();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    reduce_group(g);
    for (std::size_t other = 0; other <= g; ++other) multiply_groups(g, other);
  }
  for (std::size_t r = 0; r < count; ++r) {
    const TreeRow& row = rows_[r];
    double speed = row.jacobian.dot(tree_.velocity(to_index(row.body)));
    if (row.other_body >= 0) speed += row.other_jacobian.dot(tree_.velocity(to_index(row.other_body)));
    b_[r] = row.target - speed;
    A_[r * count + r] += row.softness;
  }
  for (const TreeTerm& term : terms_) b_[term.row] -= term.jacobian.dot(tree_.velocity(to_index(term.body)));
}

bool TreeSolver::has_terms(std::size_t row) const {
  return std::ranges::any_of(terms_, [row](const TreeTerm& term) { return term.row == row; });
}

// A row with terms is a group of its own.
void TreeSolver::make_groups() {
  groups_.clear();
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const TreeRow& row = rows_[r];
    if (has_terms(r)) {
      groups_.push_back({.first = r, .rows = 1, .support = &supports_.back()});
    } else if (!groups_.empty() && groups_.back().rows < mechanics::Lanes::kCount &&
               rows_[r - 1].body == row.body && rows_[r - 1].other_body == row.other_body &&
               !has_terms(r - 1)) {
      ++groups_.back().rows;
    } else {
      groups_.push_back({.first = r, .rows = 1, .support = &support(row)});
    }
  }
  if (reduced_.size() < groups_.size() * tree_.dofs()) reduced_.resize(groups_.size() * tree_.dofs());
}

// If one body carries the other, its path contains the other's.
const TreeSolver::Support& TreeSolver::support(const TreeRow& row) const {
  const Support& own = supports_[to_index(row.body)];
  if (row.other_body < 0) return own;
  const Support& other = supports_[to_index(row.other_body)];
  const bool is_longer = own.dofs.size() >= other.dofs.size();
  const Support& longer = is_longer ? own : other;
  const Support& shorter = is_longer ? other : own;
  return longer.dofs[shorter.dofs.size() - 1] == shorter.dofs.back() ? longer : supports_.back();
}

void TreeSolver::reduce_group(std::size_t number) {
  const RowGroup& group = groups_[number];
  const std::span<mechanics::Lanes> y = reduced(number);
  std::ranges::fill(y, mechanics::Lanes{});
  const auto add = [&](int body, const mechanics::Vector6 TreeRow::*jacobian) {
    std::array<mechanics::Lanes, 6> impulses;
    for (std::size_t lane = 0; lane < group.rows; ++lane) {
      const mechanics::Vector6& impulse = rows_[group.first + lane].*jacobian;
      for (std::size_t i = 0; i < impulses.size(); ++i)
        impulses[i][lane] = impulse[static_cast<Eigen::Index>(i)];
    }
    tree_.add_to_jacobian(to_index(body), impulses, y);
  };
  const TreeRow& row = rows_[group.first];
  add(row.body, &TreeRow::jacobian);
  if (row.other_body >= 0) add(row.other_body, &TreeRow::other_jacobian);
  for (const TreeTerm& term : terms_) {
    if (term.row != group.first) continue;
    std::array<mechanics::Lanes, 6> impulses{};
    for (std::size_t i = 0; i < impulses.size(); ++i)
      impulses[i][0] = term.jacobian[static_cast<Eigen::Index>(i)];
    tree_.add_to_jacobian(to_index(term.body), impulses, y);
  }
  tree_.reduce(group.support->dofs, y);
}

// The products of all lanes of one group, whether there are rows in them or not, with those of the other.
KOBOSHI_VECTOR_CLONES void TreeSolver::multiply_groups(std::size_t number, std::size_t other_number) {
  using mechanics::Four;
  const RowGroup& group = groups_[number];
  const RowGroup& other = groups_[other_number];
  const std::size_t count = rows_.size();
  const mechanics::Lanes* const y = &reduced_[number * tree_.dofs()];
  const mechanics::Lanes* const z = &reduced_[other_number * tree_.dofs()];
  const Support& support =
      group.support->dofs.size() <= other.support->dofs.size() ? *group.support : *other.support;
  const std::size_t* dof = support.by_sum.data();
  const std::size_t* const dofs = dof;
  std::array<std::array<Four, mechanics::Lanes::kCount>, Support::kSums> sums;  // not zeroed first
  for (std::size_t sum = 0; sum < Support::kSums; ++sum) {
    Four first = {}, second = {}, third = {}, fourth = {};
    for (const std::size_t* const end = dofs + support.ends[sum]; dof != end; ++dof) {
      const Four right = z[*dof].all;
      const mechanics::Lanes& left = y[*dof];
      first += left[0] * right;
      second += left[1] * right;
      third += left[2] * right;
      fourth += left[3] * right;
    }
    sums[sum] = {first, second, third, fourth};
  }
  for (std::size_t lane = 0; lane < group.rows; ++lane) {
    const auto sum = [&](std::size_t number_of_sum) -> const Four& { return sums[number_of_sum][lane]; };
    mechanics::Lanes products;
    products.all = (((sum(0) + sum(2)) + sum(4)) + ((sum(1) + sum(3)) + sum(5))) + sum(6);
    const std::size_t r = group.first + lane;
    for (std::size_t i = 0; i < other.rows; ++i) {
      const std::size_t s = other.first + i;
      A_[r * count + s] = A_[s * count + r] = products[i];
    }
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

// Turns the two rows and the two columns of A. It is symmetric, so that outside of the four elements where
// they cross, the columns are the rows.
KOBOSHI_VECTOR_CLONES void TreeSolver::turn_rows(const TreeFriction& friction, const FrictionRows& rows) {
  const std::size_t count = rows_.size();
  const std::size_t one = friction.row(0);
  const std::size_t two = friction.row(1);
  const double c = rows.first.x();
  const double s = rows.first.y();
  const auto turn = [c, s](double& x, double& y) {
    const double turned = c * x + s * y;
    y = -s * x + c * y;
    x = turned;
  };
  double* const A = lcp_.A().data();
  double* const row_one = A + one * count;
  double* const row_two = A + two * count;
  std::size_t r = 0;
  for (; r + 4 <= count; r += 4) {
    const mechanics::Four x = mechanics::four_at(row_one + r);
    const mechanics::Four y = mechanics::four_at(row_two + r);
    mechanics::four_at(row_one + r) = c * x + s * y;
    mechanics::four_at(row_two + r) = -s * x + c * y;
  }
  for (; r < count; ++r) turn(row_one[r], row_two[r]);
  turn(row_one[one], row_one[two]);
  turn(row_two[one], row_two[two]);
  for (r = 0; r < count; ++r) {
    if (r == one || r == two) continue;
    A[r * count + one] = row_one[r];
    A[r * count + two] = row_two[r];
  }
  turn(lcp_.b()[one], lcp_.b()[two]);
  turn(lcp_.x()[one], lcp_.x()[two]);
  row_two[two] += rows.softness;
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
  std::ranges::fill(reduced_sum_, 0.0);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const RowGroup& group = groups_[g];
    const std::span<mechanics::Lanes> y = reduced(g);
    for (const std::size_t dof : group.support->dofs) {
      double sum = reduced_sum_[dof];
      for (std::size_t lane = 0; lane < group.rows; ++lane) sum += impulse(group.first + lane) * y[dof][lane];
      reduced_sum_[dof] = sum;
    }
  }
  tree_.apply(reduced_sum_);
}

void TreeSolver::find_joint_impulses() {
  std::ranges::fill(body_impulses_, mechanics::Vector6::Zero());
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const TreeRow& row = rows_[r];
    body_impulses_[to_index(row.body)] += impulse(r) * row.jacobian;
    if (row.other_body >= 0) body_impulses_[to_index(row.other_body)] += impulse(r) * row.other_jacobian;
  }
  for (const TreeTerm& term : terms_)
    body_impulses_[to_index(term.body)] += impulse(term.row) * term.jacobian;
  tree_.find_joint_impulses(body_impulses_);
}

}  // namespace koboshi::sim_board
