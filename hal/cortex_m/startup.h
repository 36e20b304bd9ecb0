#pragma once

#include <cstdint>

// Symbols of the linker script; only their addresses are meaningful.
extern "C" {
extern std::uint32_t image_data_begin[], image_data_end[], image_data_load[];
extern std::uint32_t image_bss_begin[], image_bss_end[];
extern std::uint32_t image_ram_begin[], image_ram_end[];
extern std::uint32_t image_stack_bottom[], image_stack_top[];
}

namespace koboshi::cortex_m {

// The program, defined by the board's program folder. Called with an empty stack and initialised .data and
// .bss.
[[noreturn]] void run_image();

// The fill pattern of unused stack.
inline constexpr std::uint32_t kStackPaint = 0xC5C5'C5C5;

// Returns the largest depth of the stack since the reset, in bytes.
[[nodiscard]] std::uint32_t stack_peak_bytes();

}  // namespace koboshi::cortex_m
