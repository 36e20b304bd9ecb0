#include "hal/cortex_m/fault.h"

#include <cstddef>

#include "hal/cortex_m/registers.h"
#include "hal/cortex_m/startup.h"
#include "hal/cortex_m/vectors.h"

namespace koboshi::cortex_m {
namespace {

constexpr std::uint32_t kValid = 0x4B46'4C54;  // "KFLT"; RAM is undefined after power-on

struct Kept {
  std::uint32_t valid;
  std::uint32_t behaviour_state;
  FaultRecord record;
};

[[gnu::section(".noinit")]] alignas(Kept) std::byte storage[sizeof(Kept)];

Kept& kept() { return *reinterpret_cast<Kept*>(storage); }

// Stack frame that the core pushes when it takes an exception (ARMv7-M, B1.5.6).
struct ExceptionFrame {
  std::uint32_t r0, r1, r2, r3, r12, link_register, program_counter, program_status;
};

bool in_ram(std::uint32_t address) {
  const auto begin = reinterpret_cast<std::uintptr_t>(image_ram_begin);
  const auto end = reinterpret_cast<std::uintptr_t>(image_ram_end);
  return address >= begin && address <= end - sizeof(ExceptionFrame);
}

[[noreturn]] void reset() {
  constexpr std::uint32_t kKey = 0x05FA'0000;
  constexpr std::uint32_t kRequest = 1u << 2;
  asm volatile("dsb" ::: "memory");
  Registers::reset_control() = kKey | kRequest;
  asm volatile("dsb" ::: "memory");
  for (;;) {
  }
}

}  // namespace

const FaultRecord* last_fault() { return kept().valid == kValid ? &kept().record : nullptr; }
void clear_fault() { kept().valid = 0; }
void note_behaviour_state(std::uint32_t state) { kept().behaviour_state = state; }

// Stores the fault record. `r4_to_r11` are the program's values; `stack_pointer` points to the exception
// frame.
extern "C" [[noreturn, gnu::used]] void record_fault(const std::uint32_t* r4_to_r11,
                                                     std::uint32_t stack_pointer) {
  set_drive_enable_line(false);
  FaultRecord& record = kept().record;
  record = {};
  record.exception = Registers::interrupt_control() & 0x1FF;
  for (std::size_t i = 0; i < 8; ++i) record.r[4 + i] = r4_to_r11[i];
  record.stack_pointer = stack_pointer;
  if (in_ram(stack_pointer)) {
    const auto& frame = *reinterpret_cast<const ExceptionFrame*>(stack_pointer);
    const bool padded = (frame.program_status & (1u << 9)) != 0;  // the core aligned the stack to 8 bytes
    record.stack_pointer += static_cast<std::uint32_t>(sizeof frame) + (padded ? 4 : 0);
    record.r[0] = frame.r0;
    record.r[1] = frame.r1;
    record.r[2] = frame.r2;
    record.r[3] = frame.r3;
    record.r[12] = frame.r12;
    record.link_register = frame.link_register;
    record.program_counter = frame.program_counter;
    record.program_status = frame.program_status;
  }
  record.configurable_status = Registers::configurable_fault_status();
  record.hard_status = Registers::hard_fault_status();
  record.memory_address = Registers::memory_fault_address();
  record.bus_address = Registers::bus_fault_address();
  record.behaviour_state = kept().behaviour_state;
  record.drive_enable_line = drive_enable_line() ? 1 : 0;
  kept().valid = kValid;
  reset();
}

// The program's stack may be corrupt, so the handler restarts it at its top. It never returns to the program.
extern "C" [[gnu::naked]] void fault_handler() {
  asm volatile(
      "mov r1, sp\n"
      "ldr r2, =image_stack_top\n"
      "mov sp, r2\n"
      "push {r4-r11}\n"
      "mov r0, sp\n"
      "b record_fault\n");
}

// The default (vectors.h).
extern "C" [[gnu::weak, gnu::nothrow, gnu::alias("fault_handler")]] void systick_handler();

}  // namespace koboshi::cortex_m
