#pragma once

#include <cstdint>

#include "hal/cortex_m/registers.h"

namespace koboshi::cortex_m {

// The core's 24-bit timer, at the core clock (ARMv7-M, B3.3).
class SysTick {
 public:
  // Starts the timer free-running, without interrupt.
  static void start() { start(kMask, 0b101); }
  // Starts the timer with an exception (systick_handler, vectors.h) every `periods` clock periods, 2 to 2^24:
  // clock_Hz / 1'000 for a millisecond.
  static void start_interrupt(std::uint32_t periods) { start(periods - 1, 0b111); }
  // Returns the clock periods since `start()`, modulo 2^24. Meaningless after `start_interrupt`.
  static std::uint32_t now() { return kMask - Registers::systick_value(); }
  // Returns the clock periods from `start` to `end`, which are less than 2^24 periods apart.
  static std::uint32_t elapsed(std::uint32_t start, std::uint32_t end) { return (end - start) & kMask; }

 private:
  static constexpr std::uint32_t kMask = 0x00FF'FFFF;

  // `control`: bit 0 enables, bit 1 raises the exception, bit 2 selects the core clock.
  static void start(std::uint32_t reload, std::uint32_t control) {
    Registers::systick_reload() = reload;
    Registers::systick_value() = 0;
    Registers::systick_control() = control;
  }
};

}  // namespace koboshi::cortex_m
