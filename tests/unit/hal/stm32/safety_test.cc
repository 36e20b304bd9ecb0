#include "hal/stm32/safety.h"

#include <gtest/gtest.h>

namespace koboshi::hal::stm32 {
namespace {

TEST(IndependentWatchdog, RunsFromTheStartForHalfASecond) {
  WatchdogRegisters registers{};
  IndependentWatchdog watchdog(registers);
  constexpr std::uint32_t kOscillator_Hz = 32'000;
  EXPECT_EQ(1'000 * registers.reload * (4u << registers.prescaler) / kOscillator_Hz, 500u);
  registers.key = 0;
  watchdog.kick(1'000);
  EXPECT_EQ(registers.key, 0xAAAAu);
}

TEST(DriveEnablePin, IsLowFromTheStart) {
  volatile std::uint32_t set_reset = 0;
  DriveEnablePin pin(set_reset, 7);
  EXPECT_EQ(set_reset, 1u << 23);
  pin.set(true);
  EXPECT_EQ(set_reset, 1u << 7);
  pin.set(false);
  EXPECT_EQ(set_reset, 1u << 23);
}

}  // namespace
}  // namespace koboshi::hal::stm32
