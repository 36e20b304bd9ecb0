// Compiled once for each expression of must_not_compile in CMakeLists.txt, never linked.
#include "firmware/fixed/literals.h"

using namespace koboshi::fixed;
using namespace koboshi::fixed::literals;

[[maybe_unused]] const auto value = KOBOSHI_EXPRESSION;
