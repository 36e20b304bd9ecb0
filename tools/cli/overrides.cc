#include "tools/cli/overrides.h"

#include <algorithm>
#include <iterator>

namespace koboshi::tools {

std::vector<sim::Override> overrides_of(std::span<const std::string> sets,
                                        const std::vector<sim::Override>& options) {
  std::vector<sim::Override> all;
  std::ranges::transform(sets, std::back_inserter(all), sim::parse_override);
  std::ranges::copy_if(options, std::back_inserter(all),
                       [](const sim::Override& option) { return !option.value.empty(); });
  return all;
}

}  // namespace koboshi::tools
