#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace koboshi::hal {

// A classic CAN data frame with an 11-bit identifier (ISO 11898-1). Remote frames carry no data.
struct CanFrame {
  std::uint16_t identifier = 0;  // 0..0x7FF
  std::uint8_t size = 0;         // 0..8; of a remote frame, the size it asks for
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
  std::uint16_t receive_overruns = 0;  // frames lost because the receive ring was full; saturates

  friend bool operator==(const CanStatus&, const CanStatus&) = default;
};

// The transmit FIFOs of a CAN controller. In a single one a frame of low priority holds up whatever stands
// behind it, a SYNC behind a heartbeat, for as long as others keep the bus busy. So what differs in priority
// does not share one. Controllers with three transmit buffers or more, of which the lowest identifier is sent
// first, have them: ST's bxCAN, Bosch's M_CAN, NXP's FlexCAN.
enum TransmitFifo : std::uint8_t {  // unscoped: the index of arrays of all
  kProcessFifo = 0,                 // boot-up, NMT, SYNC, emergencies, PDOs
  kAnswerFifo = 1,                  // of SDO servers
  kBackgroundFifo = 2,              // SDO requests, heartbeats, LSS
};
inline constexpr std::size_t kTransmitFifos = 3;

// The message by which a node tells that it has been initialised (CiA 301, 7.2.8.3.3).
constexpr bool is_boot_up(const CanFrame& frame) {
  return frame.identifier > 0x700 && frame.identifier < 0x780 && !frame.remote && frame.size == 1 &&
         frame.data[0] == 0;
}

// By the predefined connection set (CiA 301, 7.3.5). The emergencies and PDOs of a node that has been reset
// stand behind its boot-up message: whoever hears them before takes them for those of the time before.
constexpr TransmitFifo transmit_fifo(const CanFrame& frame) {
  if (frame.identifier < 0x580 || is_boot_up(frame)) return kProcessFifo;
  return frame.identifier < 0x600 ? kAnswerFifo : kBackgroundFifo;
}

// A CAN controller with a receive ring and transmit FIFOs. Of their oldest frames the one with the lowest
// identifier takes part in the arbitration. Nothing blocks.
class CanPort {
 public:
  // Takes the oldest received frame. False, and `frame` untouched, when there is none.
  [[nodiscard]] virtual bool receive(CanFrame& frame) = 0;
  // Appends to the frame's FIFO, whose frames leave in this order. False when that FIFO is full.
  [[nodiscard]] virtual bool transmit(const CanFrame& frame) = 0;
  // How many frames `transmit` would take into this FIFO now.
  [[nodiscard]] virtual std::size_t transmit_space(TransmitFifo fifo) const = 0;
  // Whether a frame of this FIFO has yet to leave it.
  [[nodiscard]] virtual bool transmit_pending(TransmitFifo fifo) const = 0;
  [[nodiscard]] virtual CanStatus status() const = 0;
  // Starts the recovery from bus-off: 128 times 11 recessive bits. No effect in the other states.
  virtual void recover() = 0;

 protected:
  ~CanPort() = default;
};

}  // namespace koboshi::hal
