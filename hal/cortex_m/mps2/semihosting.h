#pragma once

#include <cstddef>
#include <span>

namespace koboshi::cortex_m::semihosting {

// Calls to the debugger that the image runs under, here QEMU (Arm IHI 0071, "Semihosting for AArch32 and
// AArch64").

enum class Mode : int { kRead = 1, kWrite = 5 };  // of binary files

// Opens a file. Returns the debugger's file handle, negative on failure.
[[nodiscard]] int open(const char* path, Mode mode);
// Reads a file; blocks until there is data. Returns the number of bytes, 0 at the end of the file.
[[nodiscard]] std::size_t read(int file, std::span<std::byte> bytes);
// Writes to a file. Returns the number of bytes written.
[[nodiscard]] std::size_t write(int file, std::span<const std::byte> bytes);
// Ends the debugger's process.
[[noreturn]] void exit();

}  // namespace koboshi::cortex_m::semihosting
