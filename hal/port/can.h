#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace koboshi::hal {

// A classic CAN data frame with an 11-bit identifier (ISO 11898-1). Remote frames carry no data.
struct CanFrame {
  std::uint16_t identifier = 0;  // 0..0x7FF
  std::uint8_t size = 0;         // 0..8; for a remote frame, the requested size
  bool remote = false;
  std::array<std::uint8_t, 8> data{};

  friend bool operator==(const CanFrame&, const CanFrame&) = default;
};

// Fault confinement state of a CAN controller (ISO 11898-1, clause 12).
enum class CanErrorState : std::uint8_t { kErrorActive = 0, kErrorPassive = 1, kBusOff = 2 };

struct CanStatus {
  CanErrorState state = CanErrorState::kErrorActive;
  std::uint8_t transmit_error_count = 0;
  std::uint8_t receive_error_count = 0;
  std::uint16_t receive_overruns = 0;  // received frames lost for lack of room; saturates

  friend bool operator==(const CanStatus&, const CanStatus&) = default;
};

// The transmit FIFOs of a CAN controller. In a single FIFO, a heartbeat that loses each arbitration would
// delay the SYNC behind it for as long as the bus is busy (priority inversion). Frames of different priority
// therefore use different FIFOs. Any controller with three transmit buffers that sends the lowest identifier
// first can implement them: ST's bxCAN, Bosch's M_CAN, NXP's FlexCAN.
enum TransmitFifo : std::uint8_t {  // unscoped, so that it can index arrays
  kProcessFifo = 0,                 // boot-up, NMT, SYNC, emergencies, PDOs
  kAnswerFifo = 1,                  // answers of SDO servers
  kBackgroundFifo = 2,              // SDO requests, heartbeats, LSS
};
inline constexpr std::size_t kTransmitFifos = 3;

// Returns whether the frame is a boot-up message, which a node sends once after its initialisation (CiA 301,
// 7.2.8.3.3).
constexpr bool is_boot_up(const CanFrame& frame) {
  return frame.identifier > 0x700 && frame.identifier < 0x780 && !frame.remote && frame.size == 1 &&
         frame.data[0] == 0;
}

// Returns the FIFO of a frame, by the predefined connection set (CiA 301, 7.3.5). Boot-up messages share the
// FIFO of emergencies and PDOs: a receiver would attribute those to the time before the reset if they
// overtook the boot-up message.
constexpr TransmitFifo transmit_fifo(const CanFrame& frame) {
  if (frame.identifier < 0x580 || is_boot_up(frame)) return kProcessFifo;
  return frame.identifier < 0x600 ? kAnswerFifo : kBackgroundFifo;
}

// A CAN controller with a receive queue and three transmit FIFOs. Among the oldest frames of the FIFOs, the
// one with the lowest identifier takes part in the arbitration. No function blocks.
class CanPort {
 public:
  // Removes the oldest received frame. Returns false, with `frame` unchanged, if there is none. The queue
  // holds at least 64 frames: 3 ms of a full bus of 1 Mbit/s, whose shortest frames take 47 bits.
  [[nodiscard]] virtual bool receive(CanFrame& frame) = 0;
  // Appends a frame to its FIFO (transmit_fifo), which keeps the order. Returns false, with nothing sent, if
  // that FIFO is full. In bus-off it appends frames likewise; `recover` may drop them. Each FIFO holds at
  // least one frame; the firmware keeps up to 32 frames that the process FIFO refuses, and 4 of each other
  // FIFO.
  [[nodiscard]] virtual bool transmit(const CanFrame& frame) = 0;
  // Returns the number of frames that `transmit` would accept into this FIFO now.
  [[nodiscard]] virtual std::size_t transmit_space(TransmitFifo fifo) const = 0;
  // Returns whether this FIFO contains a frame that is waiting or in transmission.
  [[nodiscard]] virtual bool transmit_pending(TransmitFifo fifo) const = 0;
  // Returns the present state and error counts.
  [[nodiscard]] virtual CanStatus status() const = 0;
  // Starts the recovery from bus-off, which takes 128 sequences of 11 recessive bits (ISO 11898-1). Waiting
  // frames may be dropped. No effect in other states or during a recovery.
  virtual void recover() = 0;

 protected:
  ~CanPort() = default;
};

}  // namespace koboshi::hal
