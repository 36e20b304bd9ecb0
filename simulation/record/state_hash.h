#pragma once

#include <xxhash.h>

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>

namespace koboshi::simulation {

// A running 64-bit hash (XXH3) of a run's state, field by field in the caller's order: integers little-endian
// in their own width, doubles as bit patterns. Never hashes whole structs, whose padding and layout depend on
// the machine. Fields are collected and hashed in blocks, since a call of the library costs far more than a
// field.
class StateHash {
 public:
  StateHash();
  StateHash(const StateHash& other) : StateHash() { *this = other; }
  StateHash& operator=(const StateHash& other) {
    XXH3_copyState(state_.get(), other.state_.get());
    block_ = other.block_;
    size_ = other.size_;
    return *this;
  }

  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  template <std::integral Integer>
  void add(Integer value) {
    static_assert(std::endian::native == std::endian::little);
    if (block_.size() - size_ < sizeof(value)) hash_block();
    std::memcpy(&block_[size_], &value, sizeof(value));
    size_ += sizeof(value);
  }
  void add(std::span<const double> values) { add(std::as_bytes(values)); }
  void add(std::span<const std::byte> bytes);

  // Hash of all data added so far; more may follow.
  std::uint64_t value() const;
  // The hash as 16 lower-case hexadecimal digits.
  std::string hex() const;

 private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  void hash_block();

  std::unique_ptr<XXH3_state_t, Free> state_;
  std::array<std::byte, 1024> block_{};  // added, and not hashed yet
  std::size_t size_ = 0;
};

}  // namespace koboshi::simulation
