// Compiled once for each must_not_compile expression in CMakeLists.txt, never linked.
#include "firmware/fixed/literals.h"

using namespace koboshi::fixed;
using namespace koboshi::fixed::literals;

[[maybe_unused]] const auto value = KOBOSHI_EXPRESSION;
