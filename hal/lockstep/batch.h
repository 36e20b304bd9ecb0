#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/port/ankle.h"
#include "hal/port/can.h"
#include "hal/port/imu.h"

namespace koboshi::hal {

// Inputs and outputs of one `service` call, as one message in each direction. The board fills a BatchInput;
// the ports of a BatchBoard serve the firmware from it and collect a BatchOutput. Within a process the
// structs are passed directly; another process or machine receives their encoding. Both carry the same data,
// so the runs are identical.

template <typename T, std::size_t kCapacity>
struct BoundedList {
  std::array<T, kCapacity> items{};
  std::uint16_t size = 0;

  [[nodiscard]] constexpr bool push(const T& item) {
    if (size == kCapacity) return false;
    items[size++] = item;
    return true;
  }
  [[nodiscard]] constexpr std::span<const T> view() const { return {items.data(), size}; }
  constexpr void clear() { size = 0; }
};

struct BatchInput {
  static constexpr std::size_t kMaxFrames = 64;      // capacity of the receive ring
  static constexpr std::size_t kMaxImuSamples = 16;  // capacity of the IMU's FIFO

  std::uint64_t now_us = 0;
  bool tick = false;  // `tick` follows this `service`
  CanStatus can_status;
  std::array<std::uint16_t, kTransmitFifos> transmit_space{};  // by TransmitFifo
  std::array<bool, kTransmitFifos> transmit_pending{};
  std::uint16_t imu_overruns = 0;
  BoundedList<CanFrame, kMaxFrames> frames;
  BoundedList<ImuSample, kMaxImuSamples> imu;
  std::array<bool, 2> ankle_fresh{};  // by Side
  std::array<AnkleSample, 2> ankles{};
};

struct BatchOutput {
  static constexpr std::size_t kMaxFrames = 64;  // of all transmit FIFOs together

  BoundedList<CanFrame, kMaxFrames> frames;
  bool recover = false;  // start the recovery from bus-off
  bool watchdog_kicked = false;
  bool drive_enabled = false;  // level of the line after the call
};

// Encoding: little-endian, fields in the above order without padding, lists as a 16-bit count followed by
// their items, booleans as a byte of 0 or 1. A frame is its identifier, a byte with its size and bit 7 for a
// remote frame, and 8 bytes of data. A BatchOutput ends with a flag byte: bit 0 recover, bit 1
// watchdog_kicked, bit 2 drive_enabled.
inline constexpr std::size_t kMaxFrameBytes = 2 + 1 + 8;
inline constexpr std::size_t kMaxBatchInputBytes = 8 + 1 + 5 + 3 * kTransmitFifos + 2 + 2 +
                                                   BatchInput::kMaxFrames * kMaxFrameBytes + 2 +
                                                   BatchInput::kMaxImuSamples * 16 + 2 + 2 * 16;
inline constexpr std::size_t kMaxBatchOutputBytes = 2 + BatchOutput::kMaxFrames * kMaxFrameBytes + 1;

// Writes the encoding to `bytes` and returns its length; 0 if `bytes` is too short.
[[nodiscard]] std::size_t encode(const BatchInput& input, std::span<std::byte> bytes);
[[nodiscard]] std::size_t encode(const BatchOutput& output, std::span<std::byte> bytes);
// Decodes a message. Returns false, with the struct undefined, if the message is too short or too long, has
// more items than fit, or has a value that a field cannot have.
[[nodiscard]] bool decode(std::span<const std::byte> bytes, BatchInput& input);
[[nodiscard]] bool decode(std::span<const std::byte> bytes, BatchOutput& output);

}  // namespace koboshi::hal
