#include "mechanics/box_lcp.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "mechanics/vector_clones.h"

namespace koboshi::mechanics {
namespace {

// Violation of a condition that counts as rounding, relative to the largest x or b. At 0.1 m/s, it is a speed
// of 1e-11 m/s.
constexpr double kRounding = 1e-10;
// Iterations per row before the search is given up.
constexpr int kMaxIterationsPerRow = 20;

double largest(std::span<const double> values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

double product(const double* one, const double* other, std::size_t size) {
  const auto length = static_cast<Eigen::Index>(size);
  return Eigen::VectorXd::Map(one, length).dot(Eigen::VectorXd::Map(other, length));
}

}  // namespace

BoxLcp::BoxLcp(std::size_t rows) {
  resize(rows);
  resize(0);
}

void BoxLcp::resize(std::size_t rows) {
  if (A_.size() < rows * rows) {
    A_.resize(rows * rows);
    factor_.resize(rows * rows);
    together_.resize(rows);
    for (auto* vector : {&b_, &x_, &diagonal_inverse_, &free_x_}) vector->resize(rows);
    free_.reserve(rows);
  }
  rows_ = rows;
  bounds_.resize(rows);
  sides_.resize(rows);
  free_.clear();
  factorised_ = 0;
}

bool BoxLcp::solve() {
  begin();
  const int most = kMaxIterationsPerRow * (static_cast<int>(rows_) + 1);
  for (int iteration = 0; iteration < most; ++iteration) {
    ++iterations_;
    if (!solve_free()) return false;
    if (move() && !release()) return true;
  }
  return false;
}

// Makes the start consistent: x within its bounds, and at the bound that holds it.
void BoxLcp::begin() {
  for (std::size_t i = 0; i < rows_; ++i) {
    const auto& [lower, upper] = bounds_[i];
    Side& side = sides_[i];
    if (lower == upper) {
      side = Side::kFixed;
    } else if (side == Side::kFixed || (side == Side::kLower && std::isinf(lower)) ||
               (side == Side::kUpper && std::isinf(upper))) {
      side = Side::kFree;
    }
    x_[i] = side == Side::kFree ? std::clamp(x_[i], lower, upper) : side == Side::kUpper ? upper : lower;
  }
  for (std::size_t place = free_.size(); place-- > 0;)
    if (sides_[free_[place]] != Side::kFree) hold(place, sides_[free_[place]]);
  const bool is_new = free_.empty();
  for (std::size_t i = 0; i < rows_; ++i)
    if (sides_[i] == Side::kFree && (is_new || std::ranges::find(free_, i) == free_.end()))
      free_.push_back(i);
}

void BoxLcp::hold(std::size_t place, Side side) {
  const std::size_t row = free_[place];
  sides_[row] = side;
  if (side == Side::kLower) x_[row] = bounds_[row].lower;
  if (side == Side::kUpper) x_[row] = bounds_[row].upper;
  free_.erase(free_.begin() + static_cast<std::ptrdiff_t>(place));
  factorised_ = std::min(factorised_, place);
}

bool BoxLcp::factorise() {
  while (factorised_ < free_.size()) {
    const std::size_t first = factorised_;
    const std::size_t rows = std::min(free_.size() - first, Lanes::kCount);
    const bool is_together = rows == Lanes::kCount && first > 0;
    if (is_together) factorise_together(first);
    for (std::size_t row = first; row < first + rows; ++row, ++factorised_)
      if (!factorise_row(row, is_together ? first : 0)) return false;
  }
  return true;
}

// Computes the elements of four rows in the columns before the first of them. The products are summed in the
// order of product().
KOBOSHI_VECTOR_CLONES void BoxLcp::factorise_together(std::size_t first) {
  std::array<const double*, Lanes::kCount> entries;
  for (std::size_t lane = 0; lane < Lanes::kCount; ++lane) entries[lane] = &A_[free_[first + lane] * rows_];
  for (std::size_t j = 0; j < first; ++j) {
    const double* const factor = &factor_[j * rows_];
    Four sum0 = {}, sum1 = {}, sum2 = {}, sum3 = {};
    std::size_t k = 0;
    for (; k + 4 <= j; k += 4) {
      sum0 += together_[k].all * factor[k];
      sum1 += together_[k + 1].all * factor[k + 1];
      sum2 += together_[k + 2].all * factor[k + 2];
      sum3 += together_[k + 3].all * factor[k + 3];
    }
    sum0 += sum2;
    sum1 += sum3;
    if (k + 2 <= j) {
      sum0 += together_[k].all * factor[k];
      sum1 += together_[k + 1].all * factor[k + 1];
      k += 2;
    }
    sum0 += sum1;
    if (k < j) sum0 += together_[k].all * factor[k];
    const std::size_t column = free_[j];
    const Four entry = {entries[0][column], entries[1][column], entries[2][column], entries[3][column]};
    together_[j].all = (entry - sum0) * diagonal_inverse_[j];
    for (std::size_t lane = 0; lane < Lanes::kCount; ++lane)
      factor_[(first + lane) * rows_ + j] = together_[j][lane];
  }
}

// Computes a row of the factor from the column `first` on.
bool BoxLcp::factorise_row(std::size_t row, std::size_t first) {
  const double* const entries = &A_[free_[row] * rows_];
  double* const factor = &factor_[row * rows_];
  for (std::size_t j = first; j < row; ++j)
    factor[j] = (entries[free_[j]] - product(factor, &factor_[j * rows_], j)) * diagonal_inverse_[j];
  const double square = entries[free_[row]] - product(factor, factor, row);
  if (!(square > 0.0)) return false;
  factor[row] = std::sqrt(square);
  diagonal_inverse_[row] = 1.0 / factor[row];
  return true;
}

// A_FF x_F = b_F - A_FH x_H, with F the free rows and H the held ones.
bool BoxLcp::solve_free() {
  if (!factorise()) return false;
  const std::size_t count = free_.size();
  for (std::size_t i = 0; i < count; ++i) free_x_[i] = b_[free_[i]];
  for (std::size_t row = 0; row < rows_; ++row) {
    if (sides_[row] == Side::kFree || x_[row] == 0.0) continue;
    const double* const entries = &A_[row * rows_];
    for (std::size_t i = 0; i < count; ++i) free_x_[i] -= entries[free_[i]] * x_[row];
  }
  for (std::size_t i = 0; i < count; ++i)
    free_x_[i] = (free_x_[i] - product(&factor_[i * rows_], free_x_.data(), i)) * diagonal_inverse_[i];
  for (std::size_t i = count; i-- > 0;) {
    const double* const row = &factor_[i * rows_];
    free_x_[i] *= diagonal_inverse_[i];
    for (std::size_t j = 0; j < i; ++j) free_x_[j] -= row[j] * free_x_[i];
  }
  return true;
}

bool BoxLcp::move() {
  const std::size_t count = free_.size();
  const double rounding = kRounding * largest({free_x_.data(), count});
  double share = 1.0;  // of the way
  std::size_t first = count;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [lower, upper] = bounds_[free_[i]];
    if (free_x_[i] >= lower - rounding && free_x_[i] <= upper + rounding) continue;
    const double x = x_[free_[i]];
    const double until = ((free_x_[i] < lower ? lower : upper) - x) / (free_x_[i] - x);
    if (until >= share) continue;
    share = until;
    first = i;
  }
  for (std::size_t i = 0; i < count; ++i) {
    double& x = x_[free_[i]];
    x = first == count ? free_x_[i] : x + share * (free_x_[i] - x);
  }
  if (first == count) return true;
  hold(first, free_x_[first] < bounds_[free_[first]].lower ? Side::kLower : Side::kUpper);
  return false;
}

bool BoxLcp::release() {
  double worst = kRounding * largest({b_.data(), rows_});
  std::size_t released = rows_;
  for (std::size_t i = 0; i < rows_; ++i) {
    if (sides_[i] != Side::kLower && sides_[i] != Side::kUpper) continue;
    const double w = product(&A_[i * rows_], x_.data(), rows_) - b_[i];
    const double violation = sides_[i] == Side::kLower ? -w : w;
    if (violation <= worst) continue;
    worst = violation;
    released = i;
  }
  if (released == rows_) return false;
  sides_[released] = Side::kFree;
  free_.push_back(released);
  return true;
}

}  // namespace koboshi::mechanics
