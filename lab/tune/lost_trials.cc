#include "lab/tune/lost_trials.h"

#include <fmt/core.h>

#include <numeric>

#include "base/text/text.h"

namespace koboshi::lab {

void LostTrials::add(const ScenarioTrial& trial) {
  ++trials_;
  for (std::size_t i = 0; i < kLosses.size(); ++i)
    counts_[i] += trial.outcome == kLosses[i].outcome ? 1u : 0u;
  if (first_error_.empty()) first_error_ = one_line(trial.error);
}

std::string LostTrials::text() const {
  const std::size_t lost = std::accumulate(counts_.begin(), counts_.end(), std::size_t{0});
  if (lost == 0) return {};
  std::string reasons;
  for (std::size_t i = 0; i < kLosses.size(); ++i) {
    if (counts_[i] == 0) continue;
    const std::string label = *kLosses[i].label == '\0' ? kLosses[i].name : kLosses[i].label;
    reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", counts_[i], label);
  }
  const std::string error = first_error_.empty() ? "" : "; the first error: " + first_error_;
  return fmt::format("{} of {} trials were lost: {}{}\n", lost, trials_, reasons, error);
}

}  // namespace koboshi::lab
