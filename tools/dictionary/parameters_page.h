#pragma once

#include <string>

#include "firmware/app/dictionary.h"
#include "tools/dictionary/object_dictionary.h"

namespace koboshi::tools {

// The page docs/reference/parameters.md: every parameter of the controller with its range, its default, its
// value on the named robot where that is another one, and its meaning.
std::string parameters_page_text(const NodeKind& controller, const std::string& robot,
                                 const app::ControllerValues& robot_values);

}  // namespace koboshi::tools
