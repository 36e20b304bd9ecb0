#pragma once

#include <xxhash.h>

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace koboshi::sim {

// A running 64-bit hash (XXH3) of a run's state, field by field in the caller's order: integers little-endian
// in their own width, doubles as bit patterns. Never hashes whole structs, whose padding and layout depend on
// the machine.
class StateHash {
 public:
  StateHash();
  StateHash(const StateHash& other) : StateHash() { *this = other; }
  StateHash& operator=(const StateHash& other) {
    XXH3_copyState(state_.get(), other.state_.get());
    return *this;
  }

  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  template <std::integral Integer>
  void add(Integer value) {
    std::byte bytes[sizeof(Integer)];
    for (std::size_t i = 0; i < sizeof(Integer); ++i) {
      bytes[i] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xFFu);
    }
    add(std::span<const std::byte>(bytes));
  }
  void add(std::span<const std::byte> bytes);

  // Hash of all data added so far; more may follow.
  std::uint64_t value() const;
  // The hash as 16 lower-case hexadecimal digits.
  std::string hex() const;

 private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::unique_ptr<XXH3_state_t, Free> state_;
};

}  // namespace koboshi::sim
