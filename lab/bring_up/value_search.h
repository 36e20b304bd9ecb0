#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "lab/bring_up/rungs.h"
#include "lab/bring_up/start_values.h"

namespace koboshi::lab {

// The end of a search: after a number of candidates, or at a time.
class SearchEnd {
 public:
  // `candidates` counts; without it, the search may take half of the time that is left until `end`.
  SearchEnd(std::optional<std::size_t> candidates, std::chrono::steady_clock::time_point end);

  [[nodiscard]] bool is_reached(std::size_t candidates) const;
  // "12", or "12 of 40" where the number is known.
  [[nodiscard]] std::string count_text(std::size_t candidate) const;

 private:
  std::optional<std::size_t> candidates_;
  std::chrono::steady_clock::time_point end_;
};

// The inputs of a search of start factors.
struct ValueSearch {
  // Makes a robot with other factors. Throws InputError if the values do not fit the legs.
  std::function<std::shared_ptr<TriedRobot>(const StartFactors&)> make;
  // Returns whether the rungs below the one that is searched for carry a robot.
  std::function<bool(const TriedRobot&)> lower_rungs;
  const Walk& walk;
  double speed = 0.0;  // that is wanted of the walk
  PlayOptions play;    // of the robots of the search, which have seeds of their own; the stepper is not used
  const std::function<void(const std::string&)>& progress;
};

struct SearchedValues {
  StartFactors factors;
  std::shared_ptr<TriedRobot> robot;  // null: nothing better was found
  std::size_t candidates = 0;
};

// Tries other factors than those of `start`, at random and ever closer around the best, until the end or
// until they carry all robots and 25 candidates have brought nothing better. `first` is the number of the
// first candidate: a later search with another number draws others. The same arguments give the same result
// if the end is a number of candidates. Throws Stopped.
[[nodiscard]] SearchedValues search_values(const ValueSearch& search, const StartFactors& start,
                                           const TriedRobot& start_robot, const SearchEnd& end,
                                           std::size_t first);

// "CoM height x 0.980, step time x 1.000, ..."
[[nodiscard]] std::string factors_text(const StartFactors& factors);

// The engines by which a search scores, of those that this program was built with.
[[nodiscard]] std::vector<std::string> search_engines();

}  // namespace koboshi::lab
