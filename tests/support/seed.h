#pragma once

#include <cstdint>

namespace koboshi::test {

// Seed of the tests' random cases. A failing test prints its case, so that nothing depends on which seed it is.
inline constexpr std::uint64_t kSeed = 20080114;

}  // namespace koboshi::test
