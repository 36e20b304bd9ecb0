#include "lab/learn/evolution.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "sim_board/random/random_stream.h"

namespace koboshi::lab {
namespace {

// Adam's decay rates and its guard against a division by zero: the values of its paper.
constexpr double kFirstDecay = 0.9;
constexpr double kSecondDecay = 0.999;
constexpr double kAdamGuard = 1e-8;

EvolutionState state_at(std::vector<double> start) {
  EvolutionState state{.mean = std::move(start)};
  state.first_moment.assign(state.mean.size(), 0.0);
  state.second_moment.assign(state.mean.size(), 0.0);
  return state;
}

}  // namespace

Evolution::Evolution(const EvolutionOptions& options, std::vector<double> start)
    : Evolution(options, state_at(std::move(start))) {}

Evolution::Evolution(const EvolutionOptions& options, EvolutionState state)
    : options_(options), state_(std::move(state)) {
  if (options_.population == 0 || options_.population % 2 != 0)
    throw std::logic_error("a population that does not come in pairs");
}

std::vector<std::vector<double>> Evolution::noise() const {
  sim_board::RandomStream random(options_.seed, "generation " + std::to_string(state_.generation));
  std::vector<std::vector<double>> directions(options_.population / 2);
  for (std::vector<double>& direction : directions) {
    for (std::size_t i = 0; i < state_.mean.size(); ++i) direction.push_back(random.normal());
  }
  return directions;
}

std::vector<std::vector<double>> Evolution::ask() const {
  std::vector<std::vector<double>> candidates;
  for (const std::vector<double>& direction : noise()) {
    for (const double sign : {1.0, -1.0}) {
      std::vector<double>& candidate = candidates.emplace_back(state_.mean);
      for (std::size_t i = 0; i < candidate.size(); ++i) candidate[i] += sign * options_.noise * direction[i];
    }
  }
  return candidates;
}

void Evolution::tell(std::span<const double> scores) {
  if (scores.size() != options_.population) throw std::logic_error("a wrong number of scores");
  const std::vector<double> ranks = centred_ranks(scores);
  const std::vector<std::vector<double>> directions = noise();
  std::vector<double> gradient(state_.mean.size(), 0.0);
  for (std::size_t pair = 0; pair < directions.size(); ++pair) {
    const double difference = ranks[2 * pair] - ranks[2 * pair + 1];
    for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] += difference * directions[pair][i];
  }
  ++state_.generation;
  const auto step = static_cast<double>(state_.generation);
  const double first_scale = 1.0 / (1.0 - std::pow(kFirstDecay, step));
  const double second_scale = 1.0 / (1.0 - std::pow(kSecondDecay, step));
  const double scale = 1.0 / (static_cast<double>(options_.population) * options_.noise);
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    const double slope = scale * gradient[i];
    double& first = state_.first_moment[i];
    double& second = state_.second_moment[i];
    first = kFirstDecay * first + (1.0 - kFirstDecay) * slope;
    second = kSecondDecay * second + (1.0 - kSecondDecay) * slope * slope;
    const double moved = first * first_scale / (std::sqrt(second * second_scale) + kAdamGuard);
    state_.mean[i] += options_.learning_rate * moved - options_.weight_decay * state_.mean[i];
  }
}

std::vector<double> centred_ranks(std::span<const double> scores) {
  const std::size_t size = scores.size();
  std::vector<double> ranks(size, 0.0);
  if (size < 2) return ranks;
  std::vector<std::size_t> order(size);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return scores[i]; });
  for (std::size_t begin = 0; begin < size;) {
    std::size_t end = begin + 1;
    while (end < size && scores[order[end]] == scores[order[begin]]) ++end;
    const double rank = 0.5 * static_cast<double>(begin + end - 1);
    for (; begin < end; ++begin) ranks[order[begin]] = rank / static_cast<double>(size - 1) - 0.5;
  }
  return ranks;
}

}  // namespace koboshi::lab
