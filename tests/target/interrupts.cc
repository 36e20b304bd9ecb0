// The program of a board that installs handlers of its own: SysTick, and interrupt 3 of 32. image_test.py
// links it in place of the firmware and of the board's vectors, without a change in hal/cortex_m, and runs it
// in QEMU.
#include <atomic>
#include <span>
#include <string_view>

#include "hal/cortex_m/mps2/semihosting.h"
#include "hal/cortex_m/registers.h"
#include "hal/cortex_m/startup.h"
#include "hal/cortex_m/systick.h"
#include "hal/cortex_m/vectors.h"

namespace koboshi::cortex_m {
namespace {

std::atomic<std::uint32_t> ticks{0};
std::atomic<std::uint32_t> interrupts{0};

void on_interrupt() { interrupts.fetch_add(1); }

[[gnu::section(".vectors.interrupts"), gnu::used]] constinit const auto vectors =
    interrupt_vectors<32>({{3, on_interrupt}});

void print(std::string_view text) {
  const int file = semihosting::open("/dev/stdout", semihosting::Mode::kWrite);
  static_cast<void>(semihosting::write(file, std::as_bytes(std::span(text))));
}

}  // namespace

extern "C" void systick_handler() { ticks.fetch_add(1); }

void run_image() {
  Registers::interrupt_enable(0) = 1u << 3;
  Registers::interrupt_pending(0) = 1u << 3;
  asm volatile("dsb\n isb" ::: "memory");
  SysTick::start_interrupt(1'000);
  while (ticks.load() < 3) {
  }
  print(interrupts.load() == 1 ? "both handlers ran\n" : "the interrupt had no handler\n");
  semihosting::exit();
}

}  // namespace koboshi::cortex_m
