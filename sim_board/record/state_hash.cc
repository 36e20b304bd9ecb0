#include "sim_board/record/state_hash.h"

#include <fmt/format.h>

namespace koboshi::sim {

StateHash::StateHash() : state_(XXH3_createState()) { XXH3_64bits_reset(state_.get()); }

void StateHash::add(std::span<const std::byte> bytes) {
  XXH3_64bits_update(state_.get(), bytes.data(), bytes.size());
}

std::uint64_t StateHash::value() const { return XXH3_64bits_digest(state_.get()); }

std::string StateHash::hex() const { return fmt::format("{:016x}", value()); }

}  // namespace koboshi::sim
