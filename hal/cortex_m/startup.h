#pragma once

#include <cstdint>

// Addresses that the linker script defines; only the addresses mean anything.
extern "C" {
extern std::uint32_t image_data_begin[], image_data_end[], image_data_load[];
extern std::uint32_t image_bss_begin[], image_bss_end[];
extern std::uint32_t image_ram_begin[], image_ram_end[];
extern std::uint32_t image_stack_bottom[], image_stack_top[];
}

namespace koboshi::cortex_m {

// The program, defined by the board's program folder. It runs with an empty stack; .data and .bss are
// initialised.
[[noreturn]] void run_image();

// The pattern of stack that has not been used.
inline constexpr std::uint32_t kStackPaint = 0xC5C5'C5C5;

// Returns the largest depth of the stack since the reset, in bytes.
[[nodiscard]] std::uint32_t stack_peak_bytes();

}  // namespace koboshi::cortex_m
