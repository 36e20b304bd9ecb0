#pragma once

#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// Returns a condition, or with `negate` its opposite, in negation normal form: `and`, `or` and comparisons
// alone, with nested operators of one kind joined. Comparisons are brought as near as possible to the form of
// a test, a source on the left and an integer or variable on the right.
[[nodiscard]] Expression normal_form(const Expression& condition, bool negate = false);

}  // namespace koboshi::simulation
