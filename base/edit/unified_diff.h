#pragma once

#include <string>
#include <string_view>

namespace koboshi {

// Returns the differences of two texts as a unified diff with three lines of context, as `diff -u` prints
// them and patch(1) reads them; empty for equal texts. `name` stands in the header for both.
[[nodiscard]] std::string unified_diff(std::string_view before, std::string_view after,
                                       const std::string& name);

}  // namespace koboshi
