#pragma once

#include <cstdint>

namespace koboshi::sim_board {

inline constexpr std::uint64_t kIntermission_us =
    3;  // three bits at 1 Mbit/s between frames (ISO 11898-1, 10.4.6)

}  // namespace koboshi::sim_board
