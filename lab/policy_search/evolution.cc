#include "lab/policy_search/evolution.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "sim_board/random/random_stream.h"

namespace koboshi::lab {

Evolution::Evolution(const EvolutionOptions& options, SearchState state)
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
  const double scale = 1.0 / (static_cast<double>(options_.population) * options_.noise);
  for (double& slope : gradient) slope *= scale;
  const std::vector<double> before = state_.mean;
  ascend(state_, gradient, options_.learning_rate);
  ++state_.generation;
  for (std::size_t i = 0; i < before.size(); ++i) state_.mean[i] -= options_.weight_decay * before[i];
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
