#include "simulation/record/state_hash.h"

#include <fmt/format.h>

#include <cstring>

namespace koboshi::simulation {

StateHash::StateHash() : state_(XXH3_createState()) { XXH3_64bits_reset(state_.get()); }

void StateHash::add(std::span<const std::byte> bytes) {
  if (block_.size() - size_ < bytes.size()) hash_block();
  if (bytes.size() > block_.size()) {
    XXH3_64bits_update(state_.get(), bytes.data(), bytes.size());
    return;
  }
  if (!bytes.empty()) std::memcpy(block_.data() + size_, bytes.data(), bytes.size());
  size_ += bytes.size();
}

void StateHash::hash_block() {
  XXH3_64bits_update(state_.get(), block_.data(), size_);
  size_ = 0;
}

std::uint64_t StateHash::value() const {
  StateHash whole(*this);
  whole.hash_block();
  return XXH3_64bits_digest(whole.state_.get());
}

std::string StateHash::hex() const { return fmt::format("{:016x}", value()); }

}  // namespace koboshi::simulation
