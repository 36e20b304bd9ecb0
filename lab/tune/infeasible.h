#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "base/text/error.h"

namespace koboshi::lab {

// Counts candidates of a search that cannot be simulated, by the limit of the robot or of a parameter that
// they violate.
class InfeasibleCounter {
 public:
  void add(const InputError& error) { ++counts_[error.limit()]; }
  const std::map<std::string, std::size_t>& counts() const { return counts_; }

 private:
  std::map<std::string, std::size_t> counts_;
};

// "5 of 40 candidates infeasible: the reach of the legs 3, the speed of left_knee 2\n", most frequent first;
// empty where all were feasible.
std::string infeasible_text(const std::map<std::string, std::size_t>& counts, std::size_t candidates);

}  // namespace koboshi::lab
