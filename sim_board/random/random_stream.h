#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace koboshi::sim {

// A stream of random numbers of its own for each name: adding a sensor to a robot does not change what the
// others draw. The same seed and name give the same numbers with every compiler and standard library
// (xoshiro256++ of Blackman and Vigna, https://prng.di.unimi.it, its state filled by SplitMix64), as
// std::normal_distribution would not.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);

  // 64 uniform bits.
  std::uint64_t bits();
  // Uniform in [0, 1), with 53 bits.
  double uniform();
  // Uniform within +-bound.
  double within(double bound) { return bound * (2.0 * uniform() - 1.0); }
  // Normal with mean 0 and standard deviation 1, by Marsaglia's polar method.
  double normal();

 private:
  std::array<std::uint64_t, 4> state_{};
  double spare_normal_ = 0.0;  // the method makes two at a time
  bool has_spare_ = false;
};

}  // namespace koboshi::sim
