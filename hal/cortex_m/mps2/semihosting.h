#pragma once

#include <cstddef>
#include <span>

namespace koboshi::cortex_m::semihosting {

// Calls to the debugger that the image runs under, here QEMU (Arm IHI 0071, "Semihosting for AArch32 and
// AArch64").

enum class Mode : int { kRead = 1, kWrite = 5 };  // of binary files

// A file handle of the debugger's; negative when it cannot open the file.
[[nodiscard]] int open(const char* path, Mode mode);
// Blocks until there is something, and returns how many bytes that was; 0 at the end of the file.
[[nodiscard]] std::size_t read(int file, std::span<std::byte> bytes);
// How many bytes were written.
[[nodiscard]] std::size_t write(int file, std::span<const std::byte> bytes);
// Ends the debugger's process.
[[noreturn]] void exit();

}  // namespace koboshi::cortex_m::semihosting
