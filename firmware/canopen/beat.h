#pragma once

#include <cstdint>

namespace koboshi::canopen {

// When a beat that was due at `due_us` is due next. Late by a period and more, it starts anew instead of
// catching up.
constexpr std::uint64_t next_beat(std::uint64_t due_us, std::uint64_t period_us, std::uint64_t now_us) {
  const std::uint64_t next_us = due_us + period_us;
  return next_us > now_us ? next_us : now_us + period_us;
}

}  // namespace koboshi::canopen
