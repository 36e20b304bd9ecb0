#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace koboshi::sim {

// A stream of random numbers with a name. Each name has an independent stream, so adding a sensor to a robot
// does not change the numbers of the others. Unlike std::normal_distribution, the same seed and name give the
// same numbers with every compiler and standard library (xoshiro256++ of Blackman and Vigna,
// https://prng.di.unimi.it, seeded by SplitMix64).
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);

  // Returns 64 uniform random bits.
  std::uint64_t bits();
  // Returns a uniform number in [0, 1) with 53 bits.
  double uniform();
  // Returns a uniform number within +-bound.
  double within(double bound) { return bound * (2.0 * uniform() - 1.0); }
  // Returns a normally distributed number with mean 0 and standard deviation 1, by Marsaglia's polar method.
  double normal();

 private:
  std::array<std::uint64_t, 4> state_{};
  double spare_normal_ = 0.0;  // the method generates two at a time
  bool has_spare_ = false;
};

}  // namespace koboshi::sim
