#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/motion_language/parse/joints.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// Whether the language has this word: a sensor, an operator or a function. No variable may have it as a name.
[[nodiscard]] bool is_reserved(std::string_view name);
// Whether the text is a letter or `_`, followed by letters, digits and `_`.
[[nodiscard]] bool is_identifier(std::string_view text);

// Parses an expression; constant parts are computed. `place` is that of the text's first letter. Reports the
// first error and returns nothing.
[[nodiscard]] std::optional<Expression> parse_expression(std::string_view text, const Place& place,
                                                         const std::vector<VariableSource>& variables,
                                                         const JointNames& joints, Diagnostics& diagnostics);

// Returns a condition as it is, and a number as its comparison with zero.
[[nodiscard]] Expression as_condition(Expression expression);

// Computes as the firmware does: saturates at the ends of int32, and truncates quotients. Returns nothing for
// a division by zero.
[[nodiscard]] std::optional<std::int32_t> compute(motion::Arithmetic operation, std::int32_t left,
                                                  std::int32_t right);

}  // namespace koboshi::simulation
