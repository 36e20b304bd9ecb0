#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "hal/port/can.h"
#include "hal/stm32/can_registers.h"
#include "hal/stm32/interrupt_ring.h"

namespace koboshi::hal::stm32 {

// How the controller samples a bit, in time quanta (RM0090, 32.7.7): one, then `segment_1`, the sample, then
// `segment_2`.
struct BitTiming {
  std::uint32_t prescaler;   // clock periods of a quantum, 1..1024
  std::uint32_t segment_1;   // 1..16
  std::uint32_t segment_2;   // 1..8
  std::uint32_t jump_width;  // 1..4: how far a bit stretches to follow another node's clock

  constexpr std::uint32_t quanta() const { return 1 + segment_1 + segment_2; }
  // Zero when no whole number of bits a second comes out of this clock of the peripheral bus.
  constexpr std::uint32_t bit_rate(std::uint32_t clock_Hz) const {
    return clock_Hz % (prescaler * quanta()) == 0 ? clock_Hz / (prescaler * quanta()) : 0;
  }
  constexpr std::uint32_t sample_point_permille() const { return 1'000 * (1 + segment_1) / quanta(); }
  constexpr std::uint32_t btr() const {
    return (jump_width - 1) << 24 | (segment_2 - 1) << 20 | (segment_1 - 1) << 16 | (prescaler - 1);
  }
};

// The driver of a bxCAN, in normal mode, for data and remote frames with 11-bit identifiers.
//
// Each of the port's three transmit FIFOs owns one of the three mailboxes. The hardware sends the lowest
// identifier among the mailboxes first (MCR.TXFP = 0), which is the order that the port asks for.
//
// The handlers of both interrupts have the same priority, so that neither interrupts the other, and handle
// one event a call: the interrupt is a level and calls again while there is more. Everything else is called
// by the program. Registers that clear bits by writing them are written, never read, changed and written.
class Can final : public CanPort {
 public:
  // Three times what the bus can carry in the millisecond between two calls of `Controller::service`.
  static constexpr std::size_t kReceiveCapacity = 64;
  // What a control cycle transmits at once: 20 RPDOs, SYNC and 7 telemetry PDOs.
  static constexpr std::size_t kTransmitCapacity = 32;

  // The registers must outlive the driver. Nothing is written before `start`.
  explicit Can(CanRegisters& registers) : registers_(registers) {}
  Can(const Can&) = delete;
  Can& operator=(const Can&) = delete;

  // Asks for initialisation mode; `update` does the rest. The clock of the peripheral runs and its pins are
  // set up.
  void start(const BitTiming& timing);
  // Once a millisecond, before the firmware is served: goes on with a start or a recovery once the hardware
  // has acknowledged it.
  void update();

  // Handler of the interrupt RX0: takes one frame out of the receive FIFO.
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
  // Drops the frames that have not been sent: after a recovery they would be targets from another time.
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
  // The FIFO's mailbox holds a frame. While it does, the ring is emptied by the interrupt; while it does not,
  // there is no interrupt for this mailbox, and the program may load it.
  std::array<std::atomic<bool>, kTransmitFifos> loaded_{};
  std::atomic<bool> drops_{false};  // the program empties the rings; the interrupt leaves them alone
  std::atomic<std::uint16_t> overruns_{0};
};

}  // namespace koboshi::hal::stm32
