#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "hal/port/can.h"
#include "hal/stm32/can_registers.h"

namespace koboshi::hal {

// The hardware behind stm32::CanRegisters: mailboxes, receive FIFO, error counts and modes as RM0090, section
// 32, describes them, for a driver that runs on the host.
//
//   FakeCanRegisters hardware;
//   stm32::Can can(hardware.registers);
//   hardware.connect([&] { can.on_receive_interrupt(); }, [&] { can.on_transmit_interrupt(); });
//   hardware.deliver({.identifier = 0x181});    // the interrupt takes it out of the FIFO
//
// Plain memory cannot act while it is written. So the hardware looks at its registers between two calls of
// the driver, in `settle`: what differs from the value that it showed last has been written. Within one call
// the driver therefore finds flags as they were when it began, as on a part whose peripheral clock is slow.
// The FIFO 1, interrupts of errors, time stamps and loop-back are not there.
class FakeCanRegisters {
 public:
  static constexpr std::size_t kFifoCapacity = 3;
  static constexpr int kRecoverySequences = 128;  // of 11 recessive bits

  // As after a reset: asleep.
  FakeCanRegisters();
  FakeCanRegisters(const FakeCanRegisters&) = delete;
  FakeCanRegisters& operator=(const FakeCanRegisters&) = delete;

  // The handlers of the interrupts RX0 and TX. Called from here on whenever an interrupt is active.
  void connect(std::function<void()> on_receive, std::function<void()> on_transmit);

  // Time passes: what the driver has written takes effect, and its handlers run until no interrupt is active.
  // Throws std::logic_error when a handler leaves its interrupt active for ever. Every function below begins
  // and ends with this.
  void settle();

  // --- the bus ---

  // Whether the controller takes part in the bus: in normal mode and not bus-off.
  [[nodiscard]] bool on_bus();
  // Another node's frame. Nothing happens where the controller is not on the bus or no filter lets it pass.
  void deliver(const CanFrame& frame);
  // The frame that takes part in the arbitration: the lowest identifier among the mailboxes, or the oldest
  // request where MCR.TXFP is set.
  [[nodiscard]] std::optional<CanFrame> contender();
  // That frame wins, and is acknowledged. Nothing when there is none.
  std::optional<CanFrame> send();
  // That frame is destroyed, and will be tried again: 8 transmit errors. Nothing when there is none.
  void destroy_transmission();
  // Another node's frame is destroyed: one receive error.
  void destroy_reception();
  // The bus is recessive for so many times 11 bits.
  void pass_recessive(int sequences);

  // --- what the driver sees ---
  stm32::CanRegisters registers{};

 private:
  struct Mailbox {
    bool pending = false;
    std::uint64_t request = 0;  // which it was, counted over all mailboxes
    CanFrame frame;
  };

  void take_writes();
  void show();
  void take_modes();
  void take_transmit_status();
  void take_receive_status();
  void take_requests();
  void complete(std::size_t box, std::uint32_t flags);
  [[nodiscard]] bool serve_interrupt();
  [[nodiscard]] bool accepts(const CanFrame& frame) const;
  [[nodiscard]] bool bus_off() const { return transmit_errors_ > 255; }
  [[nodiscard]] bool participates() const { return !initialisation_ && !asleep_ && !bus_off(); }
  [[nodiscard]] std::optional<std::size_t> next_box() const;

  std::function<void()> on_receive_;
  std::function<void()> on_transmit_;
  bool asleep_ = true;
  bool initialisation_ = false;
  int sequences_left_ = 0;  // of recessive bits, until the bus may be used
  std::array<Mailbox, 3> mailboxes_;
  std::uint64_t requests_ = 0;
  std::uint32_t completed_ = 0;  // RQCP, TXOK and TERR of all mailboxes
  std::deque<CanFrame> fifo_;
  bool overrun_ = false;
  bool full_ = false;
  int transmit_errors_ = 0;  // 0..256
  int receive_errors_ = 0;
  std::uint32_t bit_timing_;
  std::uint32_t shown_tsr_ = 0;
  std::uint32_t shown_rf0r_ = 0;
};

}  // namespace koboshi::hal
