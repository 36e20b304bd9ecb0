#include "hal/stm32/can.h"

#include <limits>

namespace koboshi::hal::stm32 {
namespace {

std::uint32_t word(const CanFrame& frame, std::size_t first) {
  return std::uint32_t{frame.data[first]} | std::uint32_t{frame.data[first + 1]} << 8 |
         std::uint32_t{frame.data[first + 2]} << 16 | std::uint32_t{frame.data[first + 3]} << 24;
}

void put_word(std::uint32_t word, CanFrame& frame, std::size_t first) {
  for (std::size_t i = 0; i < 4; ++i) frame.data[first + i] = static_cast<std::uint8_t>(word >> (8 * i));
}

// The request must be last: it passes ownership of the mailbox to the hardware.
void write(const CanFrame& frame, CanRegisters::Mailbox& box) {
  box.length = frame.size;
  box.data_low = word(frame, 0);
  box.data_high = word(frame, 4);
  box.identifier = std::uint32_t{frame.identifier} << mailbox::kStidShift |
                   (frame.remote ? mailbox::kRtr : 0u) | mailbox::kTxrq;
}

// A DLC of 9..15 means 8 bytes (ISO 11898-1). Bytes beyond the size are zero.
CanFrame read(const CanRegisters::Mailbox& box) {
  const std::uint32_t identifier = box.identifier;
  const std::uint32_t size = box.length & mailbox::kDlc;
  CanFrame frame{.identifier = static_cast<std::uint16_t>(identifier >> mailbox::kStidShift),
                 .size = static_cast<std::uint8_t>(size < 8 ? size : 8),
                 .remote = (identifier & mailbox::kRtr) != 0};
  put_word(box.data_low, frame, 0);
  put_word(box.data_high, frame, 4);
  for (std::size_t i = frame.remote ? 0 : frame.size; i < frame.data.size(); ++i) frame.data[i] = 0;
  return frame;
}

}  // namespace

void Can::start(const BitTiming& timing) {
  bit_timing_ = timing.btr();
  initialises_ = true;
  registers_.mcr = mcr::kInrq | mcr::kRflm;  // also leaves sleep mode
}

void Can::update() {
  if (initialises_ && (registers_.msr & msr::kInak) != 0) {
    configure();
    initialises_ = false;
    // Returns to the bus after 11 recessive bits, or from bus-off after 128 sequences of them.
    registers_.mcr = mcr::kRflm;
  }
  if (recovers_ && !initialises_ && (registers_.esr & esr::kBoff) == 0) recovers_ = false;
}

// Configures one 32-bit filter bank in mask mode: all frames with an 11-bit identifier go to FIFO 0.
void Can::configure() {
  registers_.btr = bit_timing_;
  registers_.fmr = registers_.fmr | fmr::kFinit;
  registers_.fm1r = 0;
  registers_.fs1r = 1;
  registers_.ffa1r = 0;
  registers_.filters[0].identifier = 0;
  registers_.filters[0].mask = mailbox::kIde;
  registers_.fa1r = 1;
  registers_.fmr = registers_.fmr & ~fmr::kFinit;
  registers_.ier = ier::kTmeie | ier::kFmpie0;
}

// The release takes a few clock cycles. Meanwhile the interrupt stays active, and the mailbox still shows the
// frame that has been read.
void Can::on_receive_interrupt() {
  const std::uint32_t fifo = registers_.rf0r;
  if ((fifo & rf0r::kLevel) == 0 || (fifo & rf0r::kRelease) != 0) return;
  if (!received_.push(read(registers_.receive[0]))) count_overrun();
  if ((fifo & rf0r::kOverrun) != 0) count_overrun();
  registers_.rf0r = rf0r::kRelease | (fifo & rf0r::kOverrun);
}

void Can::on_transmit_interrupt() {
  const std::uint32_t completed = registers_.tsr & tsr::kAllCompleted;
  registers_.tsr = completed;  // also clears the flags of the cause: sent, aborted or in error
  for (std::size_t fifo = 0; fifo < kTransmitFifos; ++fifo) {
    if ((completed & tsr::rqcp(fifo)) != 0) load_next(fifo);
  }
}

bool Can::transmit(const CanFrame& frame) {
  const TransmitFifo fifo = transmit_fifo(frame);
  if (!waiting_[fifo].push(frame)) return false;
  if (!loaded_[fifo].load(std::memory_order_acquire)) load_next(fifo);
  return true;
}

void Can::load_next(std::size_t fifo) {
  CanFrame frame;
  const bool more = !drops_.load(std::memory_order_acquire) && waiting_[fifo].pop(frame);
  loaded_[fifo].store(more, std::memory_order_release);  // before the request, whose end is an interrupt
  if (more) write(frame, registers_.transmit[fifo]);
}

// Called by the receive interrupt only. The flag does not give the number of lost frames: each overrun counts
// as one.
void Can::count_overrun() {
  const std::uint16_t overruns = overruns_.load(std::memory_order_relaxed);
  if (overruns < std::numeric_limits<std::uint16_t>::max())
    overruns_.store(static_cast<std::uint16_t>(overruns + 1), std::memory_order_relaxed);
}

CanStatus Can::status() const {
  const std::uint32_t errors = registers_.esr;
  CanErrorState state = CanErrorState::kErrorActive;
  if ((errors & esr::kEpvf) != 0) state = CanErrorState::kErrorPassive;
  if ((errors & esr::kBoff) != 0) state = CanErrorState::kBusOff;
  return {.state = state,
          .transmit_error_count = static_cast<std::uint8_t>(errors >> esr::kTecShift),
          .receive_error_count = static_cast<std::uint8_t>(errors >> esr::kRecShift),
          .receive_overruns = overruns_.load(std::memory_order_relaxed)};
}

void Can::recover() {
  if (recovers_ || (registers_.esr & esr::kBoff) == 0) return;
  recovers_ = true;
  drops_.store(true, std::memory_order_release);
  CanFrame dropped;
  for (auto& ring : waiting_) {
    while (ring.pop(dropped)) {
    }
  }
  drops_.store(false, std::memory_order_release);
  registers_.tsr = tsr::kAbortAll;
  initialises_ = true;
  registers_.mcr = mcr::kInrq | mcr::kRflm;
}

}  // namespace koboshi::hal::stm32
