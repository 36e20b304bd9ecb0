#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// A free body flips about its intermediate axis and stays about the others.
[[nodiscard]] Validation tennis_racket();

}  // namespace koboshi::tools
