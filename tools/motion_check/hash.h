#pragma once

#include <cstdint>

namespace koboshi::tools {

// Hashes of 64 bits: among a million values, two are confused with a probability of 3e-8.
inline constexpr std::uint64_t kHashSeed = 0x9E3779B97F4A7C15U;

// Adds a value to a hash (the finaliser of SplitMix64, Steele, Lea and Flood 2014).
constexpr void add_to_hash(std::uint64_t& hash, std::uint64_t value) {
  hash = (hash ^ value) + kHashSeed;
  hash = (hash ^ hash >> 30) * 0xBF58476D1CE4E5B9U;
  hash = (hash ^ hash >> 27) * 0x94D049BB133111EBU;
  hash ^= hash >> 31;
}

}  // namespace koboshi::tools
