#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "hal/port/can.h"
#include "hal/stm32/can_registers.h"

namespace koboshi::hal {

// Simulates the hardware behind stm32::CanRegisters for a driver that runs on the host: mailboxes, receive
// FIFO, error counts and modes as described in RM0090, section 32.
//
//   FakeCanRegisters hardware;
//   stm32::Can can(hardware.registers);
//   hardware.connect([&] { can.on_receive_interrupt(); }, [&] { can.on_transmit_interrupt(); });
//   hardware.deliver({.identifier = 0x181});    // the interrupt handler reads it from the FIFO
//
// Plain memory cannot react to writes. The hardware therefore inspects its registers between two calls of the
// driver, in `settle`: a value that differs from the last one shown has been written. Within one call the
// driver sees the flags as they were at its beginning, as on a part with a slow peripheral clock. Not
// simulated: FIFO 1, error interrupts, time stamps and loop-back.
class FakeCanRegisters {
 public:
  static constexpr std::size_t kFifoCapacity = 3;
  static constexpr int kRecoverySequences = 128;  // each of 11 recessive bits

  // Starts as after a reset: in sleep mode.
  FakeCanRegisters();
  FakeCanRegisters(const FakeCanRegisters&) = delete;
  FakeCanRegisters& operator=(const FakeCanRegisters&) = delete;

  // Sets the handlers of the interrupts RX0 and TX. They are called whenever the interrupt is active.
  void connect(std::function<void()> on_receive, std::function<void()> on_transmit);

  // Processes the driver's register writes and calls its handlers until no interrupt is active. Throws
  // std::logic_error if a handler never clears its interrupt. Every function below begins and ends with a
  // call of this function.
  void settle();

  // --- The bus ---

  // Returns whether the controller participates in the bus: in normal mode and not bus-off.
  [[nodiscard]] bool on_bus();
  // Delivers another node's frame. No effect if the controller is not on the bus or no filter accepts the
  // frame.
  void deliver(const CanFrame& frame);
  // Returns the frame that participates in the arbitration: the one with the lowest identifier in the
  // mailboxes, or the oldest request if MCR.TXFP is set.
  [[nodiscard]] std::optional<CanFrame> contender();
  // Lets that frame win the arbitration and acknowledges it. Returns nothing if there is none.
  std::optional<CanFrame> send();
  // Destroys that frame, which will be retransmitted: 8 transmit errors. No effect if there is none.
  void destroy_transmission();
  // Destroys another node's frame: one receive error.
  void destroy_reception();
  // Lets this many sequences of 11 recessive bits pass.
  void pass_recessive(int sequences);

  // --- The driver's view ---
  stm32::CanRegisters registers{};

 private:
  struct Mailbox {
    bool pending = false;
    std::uint64_t request = 0;  // sequence number of the request, over all mailboxes
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
  int sequences_left_ = 0;  // sequences of 11 recessive bits left until the controller may use the bus
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
