#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/cortex_m/fault.h"
#include "hal/lockstep/batch.h"

namespace koboshi::cortex_m::wire {

// The protocol between the image and its host, over two pipes: request, answer, request and so on. A message
// is its length u16 (without these two bytes), a kind u8 and a body; integers are little-endian. The answer
// has the kind of the request, or is kFault: a fault has reset the core, which waits for kProgram or kStart.
enum class Kind : std::uint8_t {
  kProgram = 1,    // offset u32, bytes: writes them to storage. Answer: empty
  kStart = 2,      // starts the firmware on the present storage. Answer: empty
  kServe = 3,      // BatchInput. Answer: SysTick periods u32 of the firmware's call, BatchOutput
  kStackPeak = 4,  // Answer: largest depth of the stack since the reset, bytes u32
  kProvoke = 5,    // Provocation u8: causes a fault. Answer: kFault
  kFault = 6,      // only as an answer: the FaultRecord, its fields as u32
};

enum class Provocation : std::uint8_t { kUndefinedInstruction = 0, kBadAddress = 1, kStackOverflow = 2 };

// The pipes, as named in QEMU's process.
inline constexpr const char* kRequestPath = "/dev/fd/3";
inline constexpr const char* kAnswerPath = "/dev/fd/4";

inline constexpr std::size_t kLengthBytes = 2;
inline constexpr std::size_t kHeaderBytes = kLengthBytes + 1;
inline constexpr std::size_t kMaxBodyBytes = 4 + hal::kMaxBatchInputBytes;
inline constexpr std::size_t kMaxProgramBytes = hal::kMaxBatchInputBytes;  // in one message
inline constexpr std::size_t kMaxMessageBytes = kHeaderBytes + kMaxBodyBytes;
static_assert(kMaxBodyBytes >= 4 + hal::kMaxBatchOutputBytes && kMaxBodyBytes >= sizeof(FaultRecord));
static_assert(kMaxMessageBytes <= 4096, "a message no longer than PIPE_BUF is written and read as a whole");

inline constexpr std::size_t kFaultWords = sizeof(FaultRecord) / sizeof(std::uint32_t);

inline void put_u32(std::span<std::byte> bytes, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::byte>((value >> (8 * i)) & 0xFF);
}

[[nodiscard]] inline std::uint32_t get_u32(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::to_integer<std::uint32_t>(bytes[i]) << (8 * i);
  return value;
}

// Writes the header of a message with a body of this size. Returns the size of the whole message.
[[nodiscard]] inline std::size_t put_header(std::span<std::byte> message, Kind kind, std::size_t body_size) {
  const std::size_t length = 1 + body_size;
  message[0] = static_cast<std::byte>(length & 0xFF);
  message[1] = static_cast<std::byte>(length >> 8);
  message[2] = static_cast<std::byte>(kind);
  return kLengthBytes + length;
}

// Returns whether the bytes are exactly one message.
[[nodiscard]] inline bool is_message(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeaderBytes) return false;
  const auto length = std::to_integer<std::size_t>(bytes[0]) | std::to_integer<std::size_t>(bytes[1]) << 8;
  return bytes.size() == kLengthBytes + length;
}

[[nodiscard]] inline Kind kind_of(std::span<const std::byte> message) {
  return static_cast<Kind>(message[2]);
}

}  // namespace koboshi::cortex_m::wire
