#pragma once

#include <cstdint>

namespace koboshi::test {

// A digest of integers, FNV-1a, for tests that pin the bits of a computation. The firmware promises the same
// bits for every compiler, word size and target (the lockstep of host and target rests on it), which no bound
// of an error can check. Whoever changes the computation on purpose takes the new digest from the failure.
class Digest {
 public:
  template <typename T>
  void add(T integer) {
    auto rest = static_cast<std::uint64_t>(static_cast<std::int64_t>(integer));
    for (int i = 0; i < 8; ++i, rest >>= 8) value_ = (value_ ^ (rest & 0xFF)) * 0x100'0000'01B3u;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF2'9CE4'8422'2325u;
};

}  // namespace koboshi::test
