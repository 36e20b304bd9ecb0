#include "hal/fake/can_registers.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace koboshi::hal {
namespace {

using namespace stm32;

constexpr int kMaxInterrupts = 1'000;  // limit of consecutive calls; beyond it a handler does not clear its
                                       // interrupt
constexpr std::uint32_t kResetBitTiming = 0x0123'0000;
constexpr std::uint32_t kClearedByWriting = 0x0F0F0F;  // of TSR: RQCP, TXOK, ALST and TERR of three mailboxes

CanFrame frame_of(const CanRegisters::Mailbox& box) {
  const std::uint32_t identifier = box.identifier;
  CanFrame frame{.identifier = static_cast<std::uint16_t>(identifier >> mailbox::kStidShift),
                 .size = static_cast<std::uint8_t>(box.length & mailbox::kDlc),
                 .remote = (identifier & mailbox::kRtr) != 0};
  for (std::size_t i = 0; i < frame.size && i < 8 && !frame.remote; ++i)
    frame.data[i] = static_cast<std::uint8_t>((i < 4 ? box.data_low : box.data_high) >> (8 * (i % 4)));
  return frame;
}

std::uint32_t identifier_word(const CanFrame& frame) {
  return std::uint32_t{frame.identifier} << mailbox::kStidShift | (frame.remote ? mailbox::kRtr : 0u);
}

void put(const CanFrame& frame, CanRegisters::Mailbox& box) {
  box.identifier = identifier_word(frame);
  box.length = frame.size;
  std::array<std::uint32_t, 2> words{};
  for (std::size_t i = 0; i < frame.data.size(); ++i)
    words[i / 4] |= std::uint32_t{frame.data[i]} << (8 * (i % 4));
  box.data_low = words[0];
  box.data_high = words[1];
}

}  // namespace

FakeCanRegisters::FakeCanRegisters() : bit_timing_(kResetBitTiming) {
  registers.mcr = mcr::kReset;
  registers.btr = kResetBitTiming;
  show();
}

void FakeCanRegisters::connect(std::function<void()> on_receive, std::function<void()> on_transmit) {
  on_receive_ = std::move(on_receive);
  on_transmit_ = std::move(on_transmit);
}

void FakeCanRegisters::settle() {
  take_writes();
  for (int i = 0; serve_interrupt(); ++i) {
    if (i == kMaxInterrupts) throw std::logic_error("a handler does not end the interrupt that calls it");
    take_writes();
  }
}

// --- Register writes of the driver

void FakeCanRegisters::take_writes() {
  take_modes();
  take_transmit_status();
  take_receive_status();
  take_requests();
  show();
}

void FakeCanRegisters::take_modes() {
  const std::uint32_t mode = registers.mcr;
  asleep_ = (mode & mcr::kSleep) != 0;
  if (initialisation_) bit_timing_ = registers.btr;  // read-only in every other mode
  const bool requested = (mode & mcr::kInrq) != 0;
  if (initialisation_ && !requested) sequences_left_ = bus_off() ? kRecoverySequences : 1;
  initialisation_ = requested;
}

void FakeCanRegisters::take_transmit_status() {
  const std::uint32_t written = registers.tsr;
  if (written == shown_tsr_) return;
  const std::uint32_t cleared = written & completed_ & tsr::kAllCompleted;
  // Clearing RQCP also clears the mailbox's other flags.
  completed_ &= ~(cleared * 0xF | (written & kClearedByWriting));
  for (std::size_t box = 0; box < mailboxes_.size(); ++box) {
    if ((written & tsr::abrq(box)) != 0 && mailboxes_[box].pending) complete(box, tsr::rqcp(box));
  }
}

void FakeCanRegisters::take_receive_status() {
  const std::uint32_t written = registers.rf0r;
  if (written == shown_rf0r_) return;
  if ((written & rf0r::kOverrun) != 0) overrun_ = false;
  if ((written & rf0r::kFull) != 0) full_ = false;
  if ((written & rf0r::kRelease) == 0 || fifo_.empty()) return;
  fifo_.pop_front();
  full_ = false;
}

void FakeCanRegisters::take_requests() {
  for (std::size_t box = 0; box < mailboxes_.size(); ++box) {
    if (mailboxes_[box].pending || (registers.transmit[box].identifier & mailbox::kTxrq) == 0) continue;
    mailboxes_[box] = {true, requests_++, frame_of(registers.transmit[box])};
    completed_ &= ~(tsr::rqcp(box) * 0xF);
  }
}

void FakeCanRegisters::complete(std::size_t box, std::uint32_t flags) {
  mailboxes_[box].pending = false;
  completed_ |= flags;
  registers.transmit[box].identifier = registers.transmit[box].identifier & ~mailbox::kTxrq;
}

// --- Register values for the driver

void FakeCanRegisters::show() {
  registers.msr = (initialisation_ ? msr::kInak : 0u) | (asleep_ ? msr::kSlak : 0u);
  registers.btr = bit_timing_;
  shown_tsr_ = completed_;
  for (std::size_t box = 0; box < mailboxes_.size(); ++box) {
    if (!mailboxes_[box].pending) shown_tsr_ |= tsr::tme(box);
  }
  registers.tsr = shown_tsr_;
  shown_rf0r_ = static_cast<std::uint32_t>(fifo_.size()) | (full_ ? rf0r::kFull : 0u) |
                (overrun_ ? rf0r::kOverrun : 0u);
  registers.rf0r = shown_rf0r_;
  if (!fifo_.empty()) put(fifo_.front(), registers.receive[0]);
  const int highest = std::max(transmit_errors_, receive_errors_);
  registers.esr = static_cast<std::uint32_t>(std::min(transmit_errors_, 255)) << esr::kTecShift |
                  static_cast<std::uint32_t>(receive_errors_) << esr::kRecShift |
                  (highest >= 96 ? esr::kEwgf : 0u) | (highest > 127 ? esr::kEpvf : 0u) |
                  (bus_off() ? esr::kBoff : 0u);
}

bool FakeCanRegisters::serve_interrupt() {
  const std::uint32_t enabled = registers.ier;
  if ((enabled & ier::kFmpie0) != 0 && !fifo_.empty() && on_receive_) {
    on_receive_();
    return true;
  }
  if ((enabled & ier::kTmeie) != 0 && (completed_ & tsr::kAllCompleted) != 0 && on_transmit_) {
    on_transmit_();
    return true;
  }
  return false;
}

// --- The bus

bool FakeCanRegisters::on_bus() {
  settle();
  return participates() && sequences_left_ == 0;
}

bool FakeCanRegisters::accepts(const CanFrame& frame) const {
  if ((registers.fmr & fmr::kFinit) != 0) return false;  // no reception while filters are changed
  for (std::size_t bank = 0; bank < std::size(registers.filters); ++bank) {
    if ((registers.fa1r >> bank & 1) == 0) continue;
    const std::uint32_t mask = registers.filters[bank].mask;
    if ((identifier_word(frame) & mask) == (registers.filters[bank].identifier & mask)) return true;
  }
  return false;
}

void FakeCanRegisters::deliver(const CanFrame& frame) {
  if (!on_bus()) return;
  receive_errors_ = receive_errors_ > 127 ? 127 : std::max(receive_errors_ - 1, 0);
  if (accepts(frame)) {
    const bool locked = (registers.mcr & mcr::kRflm) != 0;
    overrun_ = overrun_ || fifo_.size() == kFifoCapacity;
    if (fifo_.size() < kFifoCapacity) {
      fifo_.push_back(frame);
    } else if (!locked) {
      fifo_.back() = frame;
    }
    full_ = full_ || fifo_.size() == kFifoCapacity;
  }
  show();
  settle();
}

std::optional<std::size_t> FakeCanRegisters::next_box() const {
  const bool in_order = (registers.mcr & mcr::kTxfp) != 0;
  const auto rank = [&](std::size_t box) {
    return in_order ? mailboxes_[box].request : mailboxes_[box].frame.identifier;
  };
  std::optional<std::size_t> next;
  for (std::size_t box = 0; box < mailboxes_.size(); ++box) {
    if (!mailboxes_[box].pending) continue;
    if (!next || rank(box) < rank(*next)) next = box;
  }
  return next;
}

std::optional<CanFrame> FakeCanRegisters::contender() {
  const bool takes_part = on_bus();
  const auto box = next_box();
  return takes_part && box ? std::optional(mailboxes_[*box].frame) : std::nullopt;
}

std::optional<CanFrame> FakeCanRegisters::send() {
  const auto frame = contender();
  if (!frame) return std::nullopt;
  const std::size_t box = *next_box();
  complete(box, tsr::rqcp(box) | tsr::txok(box));
  transmit_errors_ = std::max(transmit_errors_ - 1, 0);
  show();
  settle();
  return frame;
}

void FakeCanRegisters::destroy_transmission() {
  if (!contender()) return;
  transmit_errors_ = std::min(transmit_errors_ + 8, 256);
  if (bus_off() && (registers.mcr & mcr::kAbom) != 0) sequences_left_ = kRecoverySequences;
  show();
  settle();
}

void FakeCanRegisters::destroy_reception() {
  if (!on_bus()) return;
  receive_errors_ = std::min(receive_errors_ + 1, 128);
  show();
  settle();
}

void FakeCanRegisters::pass_recessive(int sequences) {
  settle();
  if (initialisation_ || asleep_ || sequences_left_ == 0) return;
  sequences_left_ = std::max(sequences_left_ - sequences, 0);
  if (sequences_left_ > 0) return;
  if (bus_off()) transmit_errors_ = receive_errors_ = 0;
  show();
  settle();
}

}  // namespace koboshi::hal
