#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace koboshi::tools {

// A path as the way between visits.
struct Leg {
  std::size_t ticks = 0;
  std::map<std::size_t, std::size_t> passed{};  // visits with their ticks
  std::optional<std::size_t> merged_into{};     // a visit
};

// Returns the ticks of the longest way through the legs, which have visits from 0 to `visits` - 1. A way
// comes to a visit once: what a loop that sensors end adds is not bounded.
[[nodiscard]] std::size_t longest_way(const std::vector<Leg>& legs, std::size_t visits);

}  // namespace koboshi::tools
