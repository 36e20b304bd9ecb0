#include "lab/tune/infeasible.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace koboshi::lab {

std::string infeasible_text(const std::map<std::string, std::size_t>& counts, std::size_t candidates) {
  if (counts.empty()) return {};
  std::vector<std::pair<std::string, std::size_t>> limits(counts.begin(), counts.end());
  std::ranges::stable_sort(limits, std::ranges::greater{}, &std::pair<std::string, std::size_t>::second);
  std::size_t sum = 0;
  std::string list;
  for (const auto& [limit, count] : limits) {
    sum += count;
    list += (list.empty() ? "" : ", ") + limit + " " + std::to_string(count);
  }
  return std::to_string(sum) + " of " + std::to_string(candidates) + " candidates infeasible: " + list + "\n";
}

}  // namespace koboshi::lab
