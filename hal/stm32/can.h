#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "hal/port/can.h"
#include "hal/stm32/can_registers.h"
#include "hal/stm32/interrupt_ring.h"

namespace koboshi::hal::stm32 {

// Bit timing in time quanta (RM0090, 32.7.7): a synchronisation quantum, then `segment_1`, the sample point,
// then `segment_2`.
struct BitTiming {
  std::uint32_t prescaler;   // clock periods per quantum, 1..1024
  std::uint32_t segment_1;   // 1..16
  std::uint32_t segment_2;   // 1..8
  std::uint32_t jump_width;  // 1..4: resynchronisation jump width

  constexpr std::uint32_t quanta() const { return 1 + segment_1 + segment_2; }
  // Returns the bit rate for this clock of the peripheral bus, or zero if it is not an integer.
  constexpr std::uint32_t bit_rate(std::uint32_t clock_Hz) const {
    return clock_Hz % (prescaler * quanta()) == 0 ? clock_Hz / (prescaler * quanta()) : 0;
  }
  constexpr std::uint32_t sample_point_permille() const { return 1'000 * (1 + segment_1) / quanta(); }
  constexpr std::uint32_t btr() const {
    return (jump_width - 1) << 24 | (segment_2 - 1) << 20 | (segment_1 - 1) << 16 | (prescaler - 1);
  }
};

// Driver of a bxCAN in normal mode, for data and remote frames with 11-bit identifiers.
//
// Each of the port's three transmit FIFOs owns one of the three mailboxes. The hardware sends the mailbox
// with the lowest identifier first (MCR.TXFP = 0), which is the order that the port requires.
//
// The handlers of both interrupts must have the same priority, so that neither interrupts the other. Each
// call handles one event: the interrupt is level-triggered and calls again while more are pending. The
// program calls all other functions. Registers with write-to-clear bits are only written, never read,
// modified and written back.
class Can final : public CanPort {
 public:
  // Three times the number of frames that the bus carries between two calls of `Controller::service`.
  static constexpr std::size_t kReceiveCapacity = 64;
  // More frames than a control cycle transmits at once: 20 target PDOs, SYNC and the telemetry PDOs.
  static constexpr std::size_t kTransmitCapacity = 32;

  // The registers must outlive the driver. The constructor does not access them.
  explicit Can(CanRegisters& registers) : registers_(registers) {}
  Can(const Can&) = delete;
  Can& operator=(const Can&) = delete;

  // Requests initialisation mode; `update` completes the start. The peripheral's clock and pins must already
  // be set up.
  void start(const BitTiming& timing);
  // Call it every millisecond, before the firmware is serviced. Continues a start or a recovery once the
  // hardware has acknowledged it.
  void update();

  // Handler of the interrupt RX0: reads one frame from the receive FIFO.
  void on_receive_interrupt();
  // Handler of the interrupt TX: loads the mailboxes that have become empty.
  void on_transmit_interrupt();

  // --- CanPort ---

  [[nodiscard]] bool receive(CanFrame& frame) override { return received_.pop(frame); }
  [[nodiscard]] bool transmit(const CanFrame& frame) override;
  [[nodiscard]] std::size_t transmit_space(TransmitFifo fifo) const override {
    return kTransmitCapacity - waiting_[fifo].size();
  }
  [[nodiscard]] bool transmit_pending(TransmitFifo fifo) const override {
    return loaded_[fifo].load(std::memory_order_acquire);
  }
  [[nodiscard]] CanStatus status() const override;
  // Drops all unsent frames, because they would be outdated targets after the recovery.
  void recover() override;

 private:
  void configure();
  void load_next(std::size_t fifo);
  void count_overrun();

  CanRegisters& registers_;
  std::uint32_t bit_timing_ = 0;  // BTR
  bool initialises_ = false;
  bool recovers_ = false;
  InterruptRing<CanFrame, kReceiveCapacity> received_;
  std::array<InterruptRing<CanFrame, kTransmitCapacity>, kTransmitFifos> waiting_;  // by TransmitFifo
  // Whether the FIFO's mailbox contains a frame. If so, the interrupt empties the ring; if not, no interrupt
  // is pending for this mailbox, and the program may load it.
  std::array<std::atomic<bool>, kTransmitFifos> loaded_{};
  std::atomic<bool> drops_{false};  // the program is emptying the rings, so the interrupt must not access
                                    // them
  std::atomic<std::uint16_t> overruns_{0};
};

}  // namespace koboshi::hal::stm32
