#include "lab/tune/search.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text/text.h"

namespace koboshi::lab {

std::vector<double> start_of(std::span<const SearchedNumber> numbers) {
  std::vector<double> x;
  for (const SearchedNumber& number : numbers) {
    x.push_back(std::clamp((number.start - number.low) / (number.high - number.low), 0.0, 1.0));
  }
  return x;
}

std::vector<double> values_at(std::span<const SearchedNumber> numbers, const std::vector<double>& x) {
  std::vector<double> values;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto& [path, low, high, grid, start] = numbers[i];
    const double steps = std::round((low + x[i] * (high - low)) / grid);
    // A grid of 0.02 is no binary fraction, the 50 steps of a unit are.
    const double per_unit = std::round(1.0 / grid);
    const bool divides_unit = std::abs(per_unit * grid - 1.0) < 1e-9;
    values.push_back(std::clamp(divides_unit ? steps / per_unit : steps * grid, low, high));
  }
  return values;
}

std::string counts_text(const CandidateCounts& counts) {
  std::string text = count_text(counts.candidates, "candidate");
  if (counts.evaluated < counts.candidates)
    text +=
        fmt::format(", {} evaluated and {} repeated", counts.evaluated, counts.candidates - counts.evaluated);
  return text;
}

Search::Search(Setup setup, const SearchOptions& options, const ShowProgress& progress)
    : setup_(std::move(setup)), options_(options), progress_(progress) {
  if (options.out.empty()) return;
  log_.emplace(options.out / "evaluations.csv");
  log_->write(csv_line(head()));
}

const Candidate& Search::evaluate(const std::vector<double>& x) {
  Candidate candidate{.numbers = values_at(setup_.numbers, x)};
  try {
    setup_.evaluate(candidate);
  } catch (const InputError& error) {
    return add_infeasible(std::move(candidate), error);
  }
  return add(std::move(candidate));
}

const Candidate& Search::add_infeasible(Candidate candidate, const InputError& error) {
  if (candidates_.empty()) throw InputError(error);  // the start is the user's, and wrong
  infeasible_.add(error);
  candidate.scores = setup_.infeasible.scores;
  candidate.score = setup_.infeasible.score;
  candidate.violated = error.limit();
  return add(std::move(candidate));
}

const Candidate& Search::add(Candidate candidate) {
  different_.insert(candidate.numbers);
  candidates_.push_back(std::move(candidate));
  if (log_) {
    log_->write(csv_line(row(candidates_.size() - 1)));
    log_->flush();  // an evaluation takes minutes
  }
  if (progress_) progress_({counts(), options_.evaluations, candidates_.back().score, best().score});
  return candidates_.back();
}

const Candidate& Search::best() const {
  return *std::ranges::max_element(candidates_, {}, &Candidate::score);
}

SearchResult Search::finish() {
  if (log_) log_->close();
  SearchResult result{.score = best().score, .counts = counts(), .infeasible = infeasible_.counts()};
  for (std::size_t i = 0; i < setup_.numbers.size(); ++i) {
    result.numbers.emplace_back(setup_.numbers[i].path, best().numbers[i]);
  }
  return result;
}

Row Search::head() const {
  Row head{"evaluation"};
  for (const SearchedNumber& number : setup_.numbers) head.push_back(number.path);
  head.insert(head.end(), setup_.columns.begin(), setup_.columns.end());
  return head;
}

Row Search::row(std::size_t number) const {
  const Candidate& candidate = candidates_[number];
  Row row{std::to_string(number + 1)};
  for (const double value : candidate.numbers) row.push_back(csv_cell(value));
  for (const std::string& cell : setup_.cells(candidate)) row.push_back(cell);
  return row;
}

}  // namespace koboshi::lab
