#pragma once

#include <cstdint>

namespace koboshi::hal {

// Of what a robot has two of. The values are indices of arrays of both.
enum class Side : std::uint8_t { kLeft = 0, kRight = 1 };

}  // namespace koboshi::hal
