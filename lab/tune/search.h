#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/file/output_file.h"
#include "base/table/table.h"
#include "base/yaml/yaml_tree.h"
#include "lab/tune/infeasible.h"

namespace koboshi::lab {

// The common part of the searches for the parameters of a gait and of a study.

// A parameter that a search may change: a value of a scenario, such as a parameter of the controller, or of
// a gait, by its dotted path.
struct SearchedNumber {
  std::string path;
  double low = 0.0;
  double high = 0.0;
  double grid = 0.0;  // the value is a multiple of it
  double start = 0.0;
};

// The start in the unit box, in which optimisers search.
[[nodiscard]] std::vector<double> start_of(std::span<const SearchedNumber> numbers);
// The parameters of a point of the unit box. They lie on their grids, so that the value in a file is the one
// that was evaluated.
[[nodiscard]] std::vector<double> values_at(std::span<const SearchedNumber> numbers,
                                            const std::vector<double>& x);

struct SearchOptions {
  std::vector<Override> overrides{};  // of the scenario, in all trials
  std::filesystem::path out{};        // folder of the log and the result; empty: neither
  std::uint64_t first_seed = 9000;
  std::size_t seeds = 3;
  std::size_t evaluations = 200;  // candidates; one that rounds to an earlier one counts, too
  std::size_t population = 8;     // of a generation
  double spread = 0.15;  // of the first generation about the start: standard deviation, as a share of ranges
  std::size_t jobs = 1;
};

// Candidates of a search. Those that round to the parameters of an earlier one are not evaluated again.
struct CandidateCounts {
  std::size_t candidates = 0;
  std::size_t evaluated = 0;
};
// "20 candidates", or "20 candidates, 17 evaluated and 3 repeated".
[[nodiscard]] std::string counts_text(const CandidateCounts& counts);

struct SearchProgress {
  CandidateCounts done{};
  std::size_t total = 0;  // candidates
  double score = 0.0;     // of the last candidate
  double best = 0.0;
};
using ShowProgress = std::function<void(const SearchProgress&)>;

struct SearchResult {
  std::vector<std::pair<std::string, double>> numbers{};  // by path
  double score = 0.0;  // mean over the seeds that were searched on: more than it will get on others
  CandidateCounts counts{};
  std::map<std::string, std::size_t> infeasible{};  // candidates by the limit that they violate
  std::string lost{};                               // LostTrials::text() of a study
};

// An evaluated set of parameters.
struct Candidate {
  std::vector<double> numbers{};
  std::vector<double> scores{};  // of each objective, to become large
  double score = 0.0;            // of all
  std::string violated{};        // the limit that makes it infeasible; empty: feasible
};

// Evaluates candidates and keeps them, in memory and as rows of evaluations.csv.
class Search {
 public:
  struct Setup {
    std::vector<SearchedNumber> numbers{};
    // Sets the scores. Throws InputError for a candidate that violates a limit.
    std::function<void(Candidate&)> evaluate{};
    // Has the scores of every infeasible candidate.
    Candidate infeasible{};
    // Columns of evaluations.csv after the parameters, and their cells.
    Row columns{};
    std::function<Row(const Candidate&)> cells{};
  };

  Search(Setup setup, const SearchOptions& options, const ShowProgress& progress);

  // At a point of the unit box. Rethrows the error of an infeasible first candidate: the start must be
  // feasible.
  const Candidate& evaluate(const std::vector<double>& x);
  // Keeps a candidate that the caller has evaluated, or found to be infeasible, in which case it gets the
  // scores of all of these. Throws the error of an infeasible first candidate.
  const Candidate& add(Candidate candidate);
  const Candidate& add_infeasible(Candidate candidate, const InputError& error);
  // Closes evaluations.csv. There is none if the folder of the options is empty.
  SearchResult finish();

  const std::vector<Candidate>& candidates() const { return candidates_; }
  CandidateCounts counts() const { return {candidates_.size(), different_.size()}; }
  const Candidate& best() const;
  const InfeasibleCounter& infeasible() const { return infeasible_; }
  // The head of evaluations.csv, and the row of a candidate.
  Row head() const;
  Row row(std::size_t number) const;

 private:
  const Setup setup_;
  const SearchOptions& options_;
  const ShowProgress& progress_;
  std::optional<OutputFile> log_{};
  std::vector<Candidate> candidates_;
  std::set<std::vector<double>> different_;  // their parameters
  InfeasibleCounter infeasible_;
};

}  // namespace koboshi::lab
