#include "lab/tune/cma_es.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace koboshi::lab {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Bounds of the spread: above, all candidates lie on the box; below, they are one point in double precision.
constexpr double kMaxSigma = 1.0;
constexpr double kMinSigma = 1e-14;
// Smallest ratio of eigenvalues: the inverse of the covariance must keep some digits.
constexpr double kMinEigenvalueRatio = 1e-14;

VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
}

// log(mu + 1/2) - log(i), normalised, of the better half.
VectorXd recombination_weights(std::size_t population) {
  const std::size_t mu = population / 2;
  VectorXd weights(static_cast<Index>(mu));
  for (std::size_t i = 0; i < mu; ++i) {
    weights(static_cast<Index>(i)) =
        std::log(0.5 * static_cast<double>(population + 1)) - std::log(static_cast<double>(i + 1));
  }
  return weights / weights.sum();
}

}  // namespace

CmaEs::CmaEs(const std::vector<double>& start, const CmaEsOptions& options)
    : dimensions_(static_cast<Index>(start.size())),
      population_(std::max<std::size_t>(options.population, 4)),
      weights_(recombination_weights(population_)),
      random_(options.seed, "candidates"),
      mean_(vector_of(start)),
      sigma_(options.spread),
      path_sigma_(VectorXd::Zero(dimensions_)),
      path_c_(VectorXd::Zero(dimensions_)),
      covariance_(MatrixXd::Identity(dimensions_, dimensions_)),
      directions_(covariance_),
      axes_(VectorXd::Ones(dimensions_)),
      best_(start),
      best_loss_(std::numeric_limits<double>::infinity()) {
  const double n = static_cast<double>(dimensions_);
  mu_eff_ = 1.0 / weights_.squaredNorm();
  c_sigma_ = (mu_eff_ + 2.0) / (n + mu_eff_ + 5.0);
  d_sigma_ = 1.0 + 2.0 * std::max(0.0, std::sqrt((mu_eff_ - 1.0) / (n + 1.0)) - 1.0) + c_sigma_;
  c_c_ = (4.0 + mu_eff_ / n) / (n + 4.0 + 2.0 * mu_eff_ / n);
  c_1_ = 2.0 / ((n + 1.3) * (n + 1.3) + mu_eff_);
  c_mu_ = std::min(1.0 - c_1_, 2.0 * (mu_eff_ - 2.0 + 1.0 / mu_eff_) / ((n + 2.0) * (n + 2.0) + mu_eff_));
  chi_n_ = std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
  draw();
}

void CmaEs::draw() {
  candidates_.clear();
  losses_.assign(population_, std::nullopt);
  for (std::size_t number = 0; number < population_; ++number) {
    VectorXd z(dimensions_);
    for (double& value : z) value = random_.normal();
    const VectorXd x = generation_ == 0 && number == 0
                           ? mean_
                           : VectorXd(mean_ + sigma_ * (directions_ * axes_.cwiseProduct(z)));
    std::vector<double>& candidate = candidates_.emplace_back();
    for (const double value : x) candidate.push_back(std::clamp(value, 0.0, 1.0));
  }
}

bool CmaEs::tell(std::size_t number, double loss) {
  // Whatever has no loss is worse than all others.
  losses_.at(number) = std::isnan(loss) ? std::numeric_limits<double>::infinity() : loss;
  if (!std::ranges::all_of(losses_, [](const auto& known) { return known.has_value(); })) return false;
  learn();
  ++generation_;
  draw();
  return true;
}

void CmaEs::move_to(const std::vector<double>& mean) {
  mean_ = vector_of(mean);
  draw();
}

void CmaEs::learn() {
  std::vector<std::size_t> order(population_);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [this](std::size_t number) { return *losses_[number]; });
  if (*losses_[order.front()] < best_loss_) {
    best_ = candidates_[order.front()];
    best_loss_ = *losses_[order.front()];
  }
  const Index mu = weights_.size();
  MatrixXd steps(dimensions_, mu);  // y of the better half
  for (Index i = 0; i < mu; ++i)
    steps.col(i) = (vector_of(candidates_[order[static_cast<std::size_t>(i)]]) - mean_) / sigma_;
  const VectorXd step = steps * weights_;
  mean_ += sigma_ * step;

  const VectorXd whitened = directions_ * (directions_.transpose() * step).cwiseQuotient(axes_);
  path_sigma_ = (1.0 - c_sigma_) * path_sigma_ + std::sqrt(c_sigma_ * (2.0 - c_sigma_) * mu_eff_) * whitened;
  const double n = static_cast<double>(dimensions_);
  const double forgotten = 1.0 - std::pow(1.0 - c_sigma_, 2.0 * static_cast<double>(generation_ + 1));
  const bool is_short = path_sigma_.norm() / std::sqrt(forgotten) < (1.4 + 2.0 / (n + 1.0)) * chi_n_;
  path_c_ *= 1.0 - c_c_;
  if (is_short) path_c_ += std::sqrt(c_c_ * (2.0 - c_c_) * mu_eff_) * step;
  const double lost = is_short ? 0.0 : c_1_ * c_c_ * (2.0 - c_c_);
  covariance_ = (1.0 + lost - c_1_ - c_mu_) * covariance_ + c_1_ * path_c_ * path_c_.transpose() +
                c_mu_ * steps * weights_.asDiagonal() * steps.transpose();
  sigma_ *= std::exp(c_sigma_ / d_sigma_ * (path_sigma_.norm() / chi_n_ - 1.0));
  sigma_ = std::clamp(sigma_, kMinSigma, kMaxSigma);
  factorise();
}

void CmaEs::factorise() {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(0.5 * (covariance_ + covariance_.transpose()));
  directions_ = solver.eigenvectors();
  const double least = kMinEigenvalueRatio * solver.eigenvalues().maxCoeff();
  axes_ = solver.eigenvalues().cwiseMax(least).cwiseSqrt();
}

void migrate(std::vector<CmaEs>& islands) {
  // As all were before any of them moved.
  std::vector<std::pair<double, std::vector<double>>> best;
  for (const CmaEs& island : islands) best.emplace_back(island.best_loss(), island.best());
  for (std::size_t i = 0; i < islands.size(); ++i) {
    const auto& [loss, x] = best[(i + islands.size() - 1) % islands.size()];
    if (loss < best[i].first) islands[i].move_to(x);
  }
}

}  // namespace koboshi::lab
