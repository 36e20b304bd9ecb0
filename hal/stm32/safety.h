#pragma once

#include <cstdint>

#include "hal/port/safety.h"

namespace koboshi::hal::stm32 {

// The independent watchdog (RM0090, section 21). It has its own oscillator of 17 to 47 kHz, so a failure of
// the core's clock does not stop it.
struct WatchdogRegisters {
  volatile std::uint32_t key;
  volatile std::uint32_t prescaler;
  volatile std::uint32_t reload;
  volatile std::uint32_t status;
};

// Resets the part if it is not kicked for 0.34 to 0.94 s (500 ms at the oscillator's nominal 32 kHz). The
// constructor starts it; it cannot be stopped.
class IndependentWatchdog final : public WatchdogPort {
 public:
  static constexpr std::uint32_t kStart = 0xCCCC;
  static constexpr std::uint32_t kUnlock = 0x5555;
  static constexpr std::uint32_t kFeed = 0xAAAA;
  static constexpr std::uint32_t kDivideBy16 = 2;
  static constexpr std::uint32_t kReload = 1'000;  // range 0..4095, at 2 kHz

  explicit IndependentWatchdog(WatchdogRegisters& registers) : registers_(registers) {
    registers_.key = kStart;
    registers_.key = kUnlock;
    registers_.prescaler = kDivideBy16;
    registers_.reload = kReload;
    registers_.key = kFeed;
  }
  void kick(std::uint64_t) override { registers_.key = kFeed; }

 private:
  WatchdogRegisters& registers_;
};

// A pin of a GPIO port, driven by the register that sets and clears single pins: bit n sets, bit n + 16
// clears (RM0090, 8.4.7). The board must pull the line low while the pin is an input, as it is at reset. The
// constructor clears the pin's output bit; the program makes the pin an output after that, so that the first
// level it drives is low.
class DriveEnablePin final : public DriveEnablePort {
 public:
  // `pin` is 0..15.
  DriveEnablePin(volatile std::uint32_t& set_reset, int pin) : set_reset_(set_reset), pin_(pin) {
    write(false);
  }
  void set(bool enabled) override { write(enabled); }

 private:
  void write(bool high) { set_reset_ = 1u << (high ? pin_ : pin_ + 16); }

  volatile std::uint32_t& set_reset_;
  int pin_;
};

}  // namespace koboshi::hal::stm32
