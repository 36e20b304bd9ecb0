#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "view/recording/recording.h"

namespace koboshi::view {

struct FirstDifference {
  std::uint64_t time_us = 0;
  std::string text;  // one sentence
};

// Returns the earliest difference of two runs: recorded values, poses and frames must be equal to the last
// bit. Signals and links are compared by their names. Nothing if the runs are the same.
std::optional<FirstDifference> first_difference(const Recording& a, const Recording& b);

}  // namespace koboshi::view
