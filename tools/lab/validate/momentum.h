#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// A chain in free flight that moves its joints: neither its centre of mass nor its angular momentum notices.
[[nodiscard]] Validation momentum();

}  // namespace koboshi::tools
