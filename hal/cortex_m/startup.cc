#include "hal/cortex_m/startup.h"

#include "hal/cortex_m/registers.h"
#include "hal/cortex_m/vectors.h"

namespace koboshi::cortex_m {

std::uint32_t stack_peak_bytes() {
  const std::uint32_t* word = image_stack_bottom;
  while (word < image_stack_top && *word == kStackPaint) ++word;
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(image_stack_top) -
                                    reinterpret_cast<std::uintptr_t>(word));
}

// Makes access to the kibibyte below RAM, into which the stack would overflow, a memory fault (ARMv7-M,
// B3.5).
void guard_stack() {
  constexpr std::uint32_t kGuard_bytes = 1024;
  constexpr std::uint32_t kRegion0 = 1u << 4;        // with the "valid" bit: region 0
  constexpr std::uint32_t kNoAccess = 9u << 1 | 1u;  // size 2^(9 + 1) bytes; no access, no execution
  Registers::protection_base() =
      (reinterpret_cast<std::uintptr_t>(image_ram_begin) - kGuard_bytes) | kRegion0;
  Registers::protection_attributes() = kNoAccess;
  Registers::protection_control() = 0b101;  // enabled; the default memory map applies outside the regions
}

extern "C" [[noreturn, gnu::used]] void reset_handler() {
  const auto* const here = static_cast<std::uint32_t*>(__builtin_frame_address(0));
  for (std::uint32_t* word = image_stack_bottom; word < here - 16; ++word) *word = kStackPaint;
  const std::uint32_t* load = image_data_load;
  for (std::uint32_t* word = image_data_begin; word < image_data_end; ++word) *word = *load++;
  for (std::uint32_t* word = image_bss_begin; word < image_bss_end; ++word) *word = 0;
  Registers::handler_control() = 0b111 << 16;  // enables the separate memory, bus and usage faults
  guard_stack();
  run_image();
}

namespace {

constexpr std::size_t kSysTick = 15;  // exception number (ARMv7-M, B1.5.2)

// The vectors of the core. Those of the part's interrupts follow: section .vectors.interrupts, from the
// board.
struct VectorTable {
  const void* stack_top;
  Handler handlers[kSysTick];  // of exceptions 1 to 15
};

constexpr VectorTable make_vector_table() {
  VectorTable table{image_stack_top, {}};
  for (Handler& handler : table.handlers) handler = fault_handler;
  table.handlers[0] = reset_handler;
  table.handlers[kSysTick - 1] = systick_handler;
  return table;
}

[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable vector_table = make_vector_table();

}  // namespace

// The compiler and <cassert> call these functions on programming errors: they cause a fault.
extern "C" [[noreturn]] void __cxa_pure_virtual() { __builtin_trap(); }
extern "C" [[noreturn]] void __assert_func(const char*, int, const char*, const char*) { __builtin_trap(); }

}  // namespace koboshi::cortex_m
