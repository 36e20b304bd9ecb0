#include "lab/policy_search/ppo.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "lab/policy_search/network_batch.h"
#include "sim_board/random/random_stream.h"

namespace koboshi::lab {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Exploration neither ends nor drowns the policy.
constexpr double kLeastDeviation = 0.02;
constexpr double kLargestDeviation = 0.5;
// The epochs of a generation end when the policy has moved so far: the advantages are those of the old one.
constexpr double kLargestDivergence = 0.03;
// Norm beyond which a gradient of the actor or of the critic is scaled down, as in the implementations that
// the paper's authors published.
constexpr double kLargestGradient = 0.5;

void bound_norm(std::vector<double>& gradient) {
  const double norm = std::sqrt(std::inner_product(gradient.begin(), gradient.end(), gradient.begin(), 0.0));
  if (norm <= kLargestGradient) return;
  for (double& slope : gradient) slope *= kLargestGradient / norm;
}

// Columns of a matrix.
MatrixXd chosen_of(const MatrixXd& all, std::span<const Index> chosen) {
  MatrixXd some(all.rows(), static_cast<Index>(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i) some.col(static_cast<Index>(i)) = all.col(chosen[i]);
  return some;
}

void append(const std::vector<double>& from, Index rows, MatrixXd& to, Index& column, std::size_t columns) {
  for (std::size_t i = 0; i < columns; ++i, ++column)
    to.col(column) = Eigen::Map<const VectorXd>(from.data() + i * static_cast<std::size_t>(rows), rows);
}

void standardise(VectorXd& numbers) {
  numbers.array() -= numbers.mean();
  const double deviation = std::sqrt(numbers.squaredNorm() / static_cast<double>(numbers.size()));
  numbers /= deviation + 1e-8;
}

}  // namespace

// The steps of all paths that have an advantage, by column.
struct Ppo::Samples {
  MatrixXd inputs;
  MatrixXd actions;
  MatrixXd means;       // of the actor that played
  VectorXd deviations;  // of its exploration
  VectorXd advantages;  // standardised
  VectorXd returns;     // which the critic should have said
  double value_error = 0.0;
};

struct Ppo::Gradient {
  std::vector<double> all{};  // in the order of the parameters
  double divergence = 0.0;    // sums over the chosen steps
  double clipped = 0.0;
};

Ppo::Ppo(const PpoOptions& options, MirroredNetwork actor, std::size_t inputs, MirrorImage outputs)
    : options_(options),
      actor_(std::move(actor)),
      outputs_(std::move(outputs)),
      critic_(MirrorImage::none(inputs), options.critic, MirrorImage::none(1), false) {}

std::vector<double> Ppo::start() const {
  std::vector<double> parameters = actor_.start(options_.seed);
  parameters.insert(parameters.end(), outputs_.place.size(), std::log(options_.deviation));
  const std::vector<double> critic = critic_.start(options_.seed + 1);
  parameters.insert(parameters.end(), critic.begin(), critic.end());
  return parameters;
}

tools::Mlp Ppo::actor(const SearchState& state) const {
  return actor_.network(part(state, 0, actor_.parameters()));
}

tools::Mlp Ppo::critic(const SearchState& state) const {
  tools::Mlp critic =
      critic_.network(part(state, actor_.parameters() + outputs_.place.size(), critic_.parameters()));
  critic.layers.back().activation = policy::Activation::kLinear;
  return critic;
}

std::vector<double> Ppo::deviations(const SearchState& state) const {
  std::vector<double> deviations;
  for (const double logarithm : part(state, actor_.parameters(), outputs_.place.size()))
    deviations.push_back(std::exp(logarithm));
  return deviations;
}

std::vector<double> advantages(const Path& path, std::span<const double> values, double discount,
                               double trace) {
  if (values.size() != path.steps()) throw std::logic_error("a value for each step is needed");
  std::vector<double> advantages(path.learnable_steps(), 0.0);
  double sum = 0.0;
  for (std::size_t i = advantages.size(); i-- > 0;) {
    const double next = i + 1 < values.size() ? values[i + 1] : 0.0;
    sum = path.rewards[i] + discount * next - values[i] + discount * trace * sum;
    advantages[i] = sum;
  }
  return advantages;
}

Ppo::Samples Ppo::samples(const SearchState& state, const std::vector<Path>& paths) const {
  const auto outputs = static_cast<Index>(outputs_.place.size());
  std::size_t count = 0;
  for (const Path& path : paths) count += path.learnable_steps();
  if (count == 0) throw std::logic_error("paths without a step");
  NetworkBatch critic(this->critic(state));
  Samples samples;
  const auto inputs = static_cast<Index>(actor(state).inputs());
  samples.inputs.resize(inputs, static_cast<Index>(count));
  MatrixXd noise(outputs, static_cast<Index>(count));
  samples.advantages.resize(static_cast<Index>(count));
  samples.returns.resize(static_cast<Index>(count));
  Index at = 0;
  for (const Path& path : paths) {
    if (path.steps() == 0) continue;
    const MatrixXd seen =
        Eigen::Map<const MatrixXd>(path.inputs.data(), inputs, static_cast<Index>(path.steps()));
    const MatrixXd values = critic.forward(seen);
    const std::vector<double> better =
        advantages(path, {values.data(), path.steps()}, options_.discount, options_.trace);
    for (std::size_t i = 0; i < better.size(); ++i) {
      samples.advantages[at + static_cast<Index>(i)] = better[i];
      samples.returns[at + static_cast<Index>(i)] = better[i] + values(0, static_cast<Index>(i));
    }
    Index column = at;
    append(path.inputs, inputs, samples.inputs, column, better.size());
    append(path.noise, outputs, noise, at, better.size());
  }
  samples.value_error = std::sqrt(samples.advantages.squaredNorm() / static_cast<double>(count));
  standardise(samples.advantages);
  const std::vector<double> deviations = this->deviations(state);
  samples.deviations = Eigen::Map<const VectorXd>(deviations.data(), outputs);
  samples.means = NetworkBatch(actor(state)).forward(samples.inputs);
  samples.actions = samples.means + samples.deviations.asDiagonal() * noise;
  return samples;
}

Ppo::Gradient Ppo::gradient(const SearchState& state, const Samples& samples,
                            std::span<const Index> chosen) const {
  const MatrixXd inputs = chosen_of(samples.inputs, chosen);
  const MatrixXd actions = chosen_of(samples.actions, chosen);
  const MatrixXd old_means = chosen_of(samples.means, chosen);
  const double share = 1.0 / static_cast<double>(chosen.size());

  const std::vector<double> now = deviations(state);
  const VectorXd deviations = Eigen::Map<const VectorXd>(now.data(), samples.deviations.size());
  NetworkBatch actor(this->actor(state));
  const MatrixXd means = actor.forward(inputs);
  const MatrixXd off = deviations.cwiseInverse().asDiagonal() * (actions - means);
  const MatrixXd old_off = samples.deviations.cwiseInverse().asDiagonal() * (actions - old_means);
  const double log_widths = (deviations.array() / samples.deviations.array()).log().sum();
  MatrixXd mean_slopes = MatrixXd::Zero(means.rows(), means.cols());
  VectorXd log_slopes = VectorXd::Zero(deviations.size());
  Gradient gradient;
  for (Index i = 0; i < means.cols(); ++i) {
    const double log_ratio = 0.5 * (old_off.col(i).squaredNorm() - off.col(i).squaredNorm()) - log_widths;
    const double ratio = std::exp(log_ratio);
    gradient.divergence += ratio - 1.0 - log_ratio;
    gradient.clipped += std::abs(ratio - 1.0) > options_.clip ? 1.0 : 0.0;
    const double advantage = samples.advantages[chosen[static_cast<std::size_t>(i)]];
    const bool pays_no_more = advantage > 0.0 ? ratio > 1.0 + options_.clip : ratio < 1.0 - options_.clip;
    if (pays_no_more) continue;
    const double slope = share * advantage * ratio;
    mean_slopes.col(i) = slope * off.col(i).cwiseQuotient(deviations);
    log_slopes += (slope * (off.col(i).array().square() - 1.0)).matrix();
  }
  std::vector<double> of_actor = actor_.gradient(actor.backward(mean_slopes));
  for (std::size_t i = 0; i < outputs_.place.size(); ++i)
    of_actor.push_back(
        0.5 * (log_slopes[static_cast<Index>(i)] + log_slopes[static_cast<Index>(outputs_.place[i])]));

  NetworkBatch critic(this->critic(state));
  const MatrixXd& values = critic.forward(inputs);
  MatrixXd value_slopes(1, values.cols());
  for (Index i = 0; i < values.cols(); ++i)
    value_slopes(0, i) = share * (samples.returns[chosen[static_cast<std::size_t>(i)]] - values(0, i));
  std::vector<double> of_critic = critic_.gradient(critic.backward(value_slopes));

  bound_norm(of_actor);
  bound_norm(of_critic);
  gradient.all = std::move(of_actor);
  gradient.all.insert(gradient.all.end(), of_critic.begin(), of_critic.end());
  return gradient;
}

PpoProgress Ppo::improve(SearchState& state, const std::vector<Path>& paths) const {
  const Samples samples = this->samples(state, paths);
  const auto count = static_cast<std::size_t>(samples.inputs.cols());
  PpoProgress progress{.value_error = samples.value_error};
  sim_board::RandomStream random(options_.seed, "epochs " + std::to_string(state.generation));
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), Index{0});
  for (; progress.epochs < options_.epochs && progress.divergence <= kLargestDivergence; ++progress.epochs) {
    for (std::size_t i = count; i-- > 1;)
      std::swap(order[i], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i + 1))]);
    progress.divergence = progress.clipped = 0.0;
    for (std::size_t begin = 0; begin < count; begin += options_.minibatch) {
      const std::size_t size = std::min(options_.minibatch, count - begin);
      const Gradient gradient = this->gradient(state, samples, std::span(order).subspan(begin, size));
      ascend(state, gradient.all, options_.learning_rate);
      for (std::size_t i = 0; i < outputs_.place.size(); ++i) {
        double& logarithm = state.mean[actor_.parameters() + i];
        logarithm = std::clamp(logarithm, std::log(kLeastDeviation), std::log(kLargestDeviation));
      }
      progress.divergence += gradient.divergence / static_cast<double>(count);
      progress.clipped += gradient.clipped / static_cast<double>(count);
    }
  }
  ++state.generation;
  return progress;
}

}  // namespace koboshi::lab
