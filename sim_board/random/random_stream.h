#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string_view>

namespace koboshi::sim_board {

// A stream of random numbers with a name. Each name has an independent stream, so adding a sensor to a robot
// does not change the numbers of the others. Unlike std::normal_distribution, the same seed and name give the
// same numbers with every compiler and standard library (xoshiro256++ of Blackman and Vigna,
// https://prng.di.unimi.it, seeded by SplitMix64).
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);

  // Returns 64 uniform random bits.
  std::uint64_t bits() {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }
  // Returns a uniform number in [0, 1) with 53 bits.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  // Returns a uniform number within +-bound.
  double within(double bound) { return bound * (2.0 * uniform() - 1.0); }
  // Returns a normally distributed number with mean 0 and standard deviation 1, by Marsaglia's polar method.
  double normal() {
    if (!has_spare_) return draw_pair();
    has_spare_ = false;
    return spare_normal_;
  }

 private:
  double draw_pair();

  std::array<std::uint64_t, 4> state_{};
  double spare_normal_ = 0.0;  // the method generates two at a time
  bool has_spare_ = false;
};

}  // namespace koboshi::sim_board
