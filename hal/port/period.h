#pragma once

#include <cstdint>

namespace koboshi::hal {

// Periods at which a board calls the firmware: `service` every kServicePeriod_us, and `tick` after each call
// whose time is a multiple of kControlPeriod_us. Gaits, filters and the drives' interpolation are designed
// for these values; other periods are not supported.
inline constexpr std::uint32_t kServicePeriod_us = 1'000;
inline constexpr std::uint32_t kControlPeriod_us = 10'000;

}  // namespace koboshi::hal
