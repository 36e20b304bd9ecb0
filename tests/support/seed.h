#pragma once

#include <cstdint>

namespace koboshi::test {

// Seed of the tests' random cases. A failing test prints its case, so no failure depends on knowing the seed.
inline constexpr std::uint64_t kSeed = 20080114;

}  // namespace koboshi::test
