#pragma once

#include <cstdint>

namespace koboshi::hal {

// How often a board calls the firmware: `service` each kServicePeriod_us, and `tick` after each call whose
// time is a multiple of kControlPeriod_us. Gaits, filters and the drives' interpolation are designed for
// these; a board with other periods is another product.
inline constexpr std::uint32_t kServicePeriod_us = 1'000;
inline constexpr std::uint32_t kControlPeriod_us = 10'000;

}  // namespace koboshi::hal
