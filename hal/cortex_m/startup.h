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

// Of the board: the program. The stack is fresh, .data and .bss are as the program wants them.
[[noreturn]] void run_image();

// What untouched stack holds.
inline constexpr std::uint32_t kStackPaint = 0xC5C5'C5C5;

// The deepest that the stack has been since the reset, in bytes.
[[nodiscard]] std::uint32_t stack_peak_bytes();

}  // namespace koboshi::cortex_m
