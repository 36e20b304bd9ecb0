#include "sim_board/random/random_stream.h"

#include <cmath>

namespace koboshi::sim_board {
namespace {

std::uint64_t split_mix(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15u;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

// FNV-1a, 64 bits: http://www.isthe.com/chongo/tech/comp/fnv
std::uint64_t hash(std::string_view text) {
  std::uint64_t h = 0xCBF29CE484222325u;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  return h;
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view name) {
  // SplitMix64 mixes the seed before it is combined with the name, so that neighbouring seeds share no bits.
  std::uint64_t mixed = split_mix(seed) ^ hash(name);
  for (std::uint64_t& word : state_) word = split_mix(mixed);
}

// Returns the first of two normal numbers, and keeps the other.
double RandomStream::draw_pair() {
  double x = 0.0;
  double y = 0.0;
  double squared = 0.0;
  do {
    x = 2.0 * uniform() - 1.0;
    y = 2.0 * uniform() - 1.0;
    squared = x * x + y * y;
  } while (squared >= 1.0 || squared == 0.0);
  const double factor = std::sqrt(-2.0 * std::log(squared) / squared);
  spare_normal_ = y * factor;
  has_spare_ = true;
  return x * factor;
}

}  // namespace koboshi::sim_board
