#include "hal/cortex_m/mps2/semihosting.h"

#include <cstdint>
#include <string_view>

namespace koboshi::cortex_m::semihosting {
namespace {

enum class Operation : std::uint32_t { kOpen = 0x01, kWrite = 0x05, kRead = 0x06, kExit = 0x18 };
constexpr std::uint32_t kApplicationExit = 0x2'0026;

std::uint32_t call(Operation operation, std::uint32_t argument) {
  register std::uint32_t r0 asm("r0") = static_cast<std::uint32_t>(operation);
  register std::uint32_t r1 asm("r1") = argument;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

// Most operations take the address of three words.
std::uint32_t call(Operation operation, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const std::uint32_t block[] = {a, b, c};
  return call(operation, reinterpret_cast<std::uintptr_t>(block));
}

// Both transfers return the number of bytes that were *not* transferred.
std::size_t transfer(Operation operation, int file, std::uintptr_t bytes, std::size_t size) {
  const std::uint32_t left = call(operation, static_cast<std::uint32_t>(file), bytes, size);
  return left <= size ? size - left : 0;
}

}  // namespace

int open(const char* path, Mode mode) {
  return static_cast<int>(call(Operation::kOpen, reinterpret_cast<std::uintptr_t>(path),
                               static_cast<std::uint32_t>(mode), std::string_view(path).size()));
}

std::size_t read(int file, std::span<std::byte> bytes) {
  return transfer(Operation::kRead, file, reinterpret_cast<std::uintptr_t>(bytes.data()), bytes.size());
}

std::size_t write(int file, std::span<const std::byte> bytes) {
  return transfer(Operation::kWrite, file, reinterpret_cast<std::uintptr_t>(bytes.data()), bytes.size());
}

void exit() {
  for (;;) call(Operation::kExit, kApplicationExit);
}

}  // namespace koboshi::cortex_m::semihosting
