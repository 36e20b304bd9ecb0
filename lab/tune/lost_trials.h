#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "lab/trial/outcome.h"
#include "lab/trial/scenario_trial.h"

namespace koboshi::lab {

// Counts why the trials of a search were lost: a search in which all are lost finds nothing.
class LostTrials {
 public:
  void add(const ScenarioTrial& trial);

  // Returns "37 of 48 trials were lost: 30 energy guard, 7 falls; the first error: ...", with a line end;
  // empty if none was lost.
  std::string text() const;

 private:
  std::size_t trials_ = 0;
  std::array<std::size_t, kLosses.size()> counts_{};
  std::string first_error_{};
};

}  // namespace koboshi::lab
