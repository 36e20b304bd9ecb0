#pragma once

#include <cstdint>

#include "hal/cortex_m/registers.h"

namespace koboshi::cortex_m {

// The core's 24-bit timer, free-running at the core clock, without interrupt.
class SysTick {
 public:
  static void start() {
    Registers::systick_reload() = kMask;
    Registers::systick_value() = 0;
    Registers::systick_control() = 0b101;  // enabled, core clock
  }
  static std::uint32_t now() { return kMask - Registers::systick_value(); }
  // Returns the clock periods from `start` to `end`, which are less than 2^24 periods apart.
  static std::uint32_t elapsed(std::uint32_t start, std::uint32_t end) { return (end - start) & kMask; }

 private:
  static constexpr std::uint32_t kMask = 0x00FF'FFFF;
};

}  // namespace koboshi::cortex_m
