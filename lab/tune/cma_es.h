#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim_board/random/random_stream.h"

namespace koboshi::lab {

struct CmaEsOptions {
  std::size_t population = 8;  // candidates of a generation, at least 4
  double spread = 0.15;        // standard deviation of the first generation about the start
  std::uint32_t seed = 1;
};

// Evolution strategy with covariance matrix adaptation over the unit box, which minimises a loss: the caller
// asks for a generation, evaluates its candidates wherever and in whatever order, and tells their losses.
//
// (mu/mu_w, lambda) with the weights, learning rates and cumulation of N. Hansen, "The CMA Evolution
// Strategy: A Tutorial" (arXiv:1604.00772, 2016), table 1, without negative weights. A candidate outside of
// the box is replaced by the nearest point of the box before it is evaluated, and the strategy learns from
// that point, so that its mean stays within the box. Of equal losses the candidate with the lower number is
// the better one. The same options and losses give the same candidates, bit by bit.
class CmaEs {
 public:
  // `start` is in the unit box. It is the first candidate of the first generation.
  CmaEs(const std::vector<double>& start, const CmaEsOptions& options);

  // The candidates of this generation: `population` points of the unit box. They stay until all losses are
  // known.
  [[nodiscard]] const std::vector<std::vector<double>>& ask() const { return candidates_; }
  // Keeps the loss of a candidate, by its number in the generation. When the last one is known, learns from
  // all of them in the order of their numbers, draws the next generation and returns true. A second loss of
  // a candidate replaces the first.
  bool tell(std::size_t number, double loss);
  // Replaces the mean of the search, for a migration between islands; the spread and the covariances stay.
  // Between generations: no loss of this generation has been told. Draws the generation again.
  void move_to(const std::vector<double>& mean);

  [[nodiscard]] std::size_t generation() const { return generation_; }  // from 0
  // The best candidate of all generations that are complete, and its loss; the start and infinity before.
  [[nodiscard]] const std::vector<double>& best() const { return best_; }
  [[nodiscard]] double best_loss() const { return best_loss_; }

 private:
  void draw();
  void learn();
  void factorise();

  Eigen::Index dimensions_;
  std::size_t population_;
  // Hansen's symbols: weights w, mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu, chi_n.
  Eigen::VectorXd weights_;
  double mu_eff_ = 0.0;
  double c_sigma_ = 0.0;
  double d_sigma_ = 0.0;
  double c_c_ = 0.0;
  double c_1_ = 0.0;
  double c_mu_ = 0.0;
  double chi_n_ = 0.0;

  sim_board::RandomStream random_;
  std::size_t generation_ = 0;
  Eigen::VectorXd mean_;
  double sigma_;
  Eigen::VectorXd path_sigma_;
  Eigen::VectorXd path_c_;
  Eigen::MatrixXd covariance_;
  Eigen::MatrixXd directions_;  // B: eigenvectors of the covariance
  Eigen::VectorXd axes_;        // D: roots of its eigenvalues

  std::vector<std::vector<double>> candidates_{};
  std::vector<std::optional<double>> losses_{};
  std::vector<double> best_;
  double best_loss_;
};

// A migration between islands, in a ring: each takes the best candidate of the one before it as its mean, if
// that is better than its own best one. Between generations of all of them.
void migrate(std::vector<CmaEs>& islands);

}  // namespace koboshi::lab
