#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/canopen/nmt.h"
#include "hal/port/can.h"

namespace koboshi::canopen {

// Where a part of the stack puts the frames it sends.
class FrameSink {
 public:
  // False when there is no room; the frame is then the caller's again.
  [[nodiscard]] virtual bool send(const hal::CanFrame& frame) = 0;
  // Whether a frame of this FIFO has yet to leave for the bus, as far as is known.
  [[nodiscard]] virtual bool pending(hal::TransmitFifo) const { return false; }

 protected:
  ~FrameSink() = default;
};

// The transmit FIFOs of a CAN controller as a sink.
class CanPortSink final : public FrameSink {
 public:
  explicit CanPortSink(hal::CanPort& port) : port_(port) {}
  bool send(const hal::CanFrame& frame) override { return port_.transmit(frame); }
  bool pending(hal::TransmitFifo fifo) const override { return port_.transmit_pending(fifo); }

 private:
  hal::CanPort& port_;
};

// Little-endian fields of CAN data.
constexpr std::uint16_t load_u16(const std::uint8_t* bytes) {
  return static_cast<std::uint16_t>(bytes[0] | (bytes[1] << 8));
}
constexpr std::uint32_t load_u32(const std::uint8_t* bytes) {
  return load_u16(bytes) | (static_cast<std::uint32_t>(load_u16(bytes + 2)) << 16);
}
constexpr void store_u16(std::uint8_t* bytes, std::uint16_t value) {
  bytes[0] = static_cast<std::uint8_t>(value);
  bytes[1] = static_cast<std::uint8_t>(value >> 8);
}
constexpr void store_u32(std::uint8_t* bytes, std::uint32_t value) {
  store_u16(bytes, static_cast<std::uint16_t>(value));
  store_u16(bytes + 2, static_cast<std::uint16_t>(value >> 16));
}

struct NmtMessage {
  NmtCommand command = NmtCommand::kStart;
  std::uint8_t node_id = 0;  // 0: every node

  friend bool operator==(const NmtMessage&, const NmtMessage&) = default;
};

// An emergency message (CiA 301, 7.2.7). Code 0x0000 says that an error is gone.
struct Emergency {
  std::uint8_t node_id = 0;
  std::uint16_t code = 0;
  std::uint8_t error_register = 0;
  std::array<std::uint8_t, 5> manufacturer{};

  friend bool operator==(const Emergency&, const Emergency&) = default;
};

struct Heartbeat {
  std::uint8_t node_id = 0;
  NmtState state = NmtState::kInitialising;  // kInitialising: the boot-up message

  friend bool operator==(const Heartbeat&, const Heartbeat&) = default;
};

hal::CanFrame encode(const NmtMessage& message);
hal::CanFrame encode(const Emergency& emergency);
hal::CanFrame encode(const Heartbeat& heartbeat);

// Nothing where the frame is not such a message: wrong identifier, length, command or state, or a remote
// frame.
std::optional<NmtMessage> decode_nmt(const hal::CanFrame& frame);
std::optional<Emergency> decode_emergency(const hal::CanFrame& frame);
std::optional<Heartbeat> decode_heartbeat(const hal::CanFrame& frame);

}  // namespace koboshi::canopen
