#pragma once

#include <cstddef>
#include <cstdint>

namespace koboshi::hal::stm32 {

using Register = volatile std::uint32_t;

// Registers of ST's bxCAN (RM0090 for the STM32F4, section 32.9; identical in RM0008 for the STM32F1). On the
// part this struct is at the peripheral's address, CAN1 at 0x4000'6400; on the host it is a part of
// hal/fake/can_registers.h.
struct CanRegisters {
  struct Mailbox {
    Register identifier;  // TIxR, RIxR
    Register length;      // TDTxR, RDTxR
    Register data_low;    // bytes 0..3, byte 0 in the lowest bits
    Register data_high;   // bytes 4..7
  };
  struct FilterBank {
    Register identifier;
    Register mask;
  };

  Register mcr;
  Register msr;
  Register tsr;
  Register rf0r;
  Register rf1r;
  Register ier;
  Register esr;
  Register btr;
  Register reserved_020[88];
  Mailbox transmit[3];
  Mailbox receive[2];
  Register reserved_1d0[12];
  Register fmr;
  Register fm1r;
  Register reserved_208;
  Register fs1r;
  Register reserved_210;
  Register ffa1r;
  Register reserved_218;
  Register fa1r;
  Register reserved_220[8];
  FilterBank filters[14];
};
static_assert(offsetof(CanRegisters, transmit) == 0x180);
static_assert(offsetof(CanRegisters, receive) == 0x1B0);
static_assert(offsetof(CanRegisters, fmr) == 0x200);
static_assert(offsetof(CanRegisters, fa1r) == 0x21C);
static_assert(offsetof(CanRegisters, filters) == 0x240);

// Bits with the manual's names. Access types: rw read and write; rs set by software, cleared by hardware;
// rc_w1 cleared by writing 1, while writing 0 has no effect; r read only.
namespace mcr {
inline constexpr std::uint32_t kInrq = 1u << 0;  // rw: requests initialisation mode
inline constexpr std::uint32_t kSleep = 1u << 1;
inline constexpr std::uint32_t kTxfp = 1u << 2;  // transmits in the order of requests instead of identifiers
inline constexpr std::uint32_t kRflm = 1u << 3;  // a full receive FIFO keeps its frames and loses new ones
inline constexpr std::uint32_t kAbom = 1u << 6;  // automatic recovery from bus-off
inline constexpr std::uint32_t kDbf = 1u << 16;  // stops while a debugger halts the core
inline constexpr std::uint32_t kReset = kDbf | kSleep;
}  // namespace mcr

namespace msr {
inline constexpr std::uint32_t kInak = 1u << 0;  // r: initialisation mode
inline constexpr std::uint32_t kSlak = 1u << 1;  // r: sleep mode
}  // namespace msr

namespace tsr {
constexpr std::uint32_t rqcp(std::size_t box) { return 1u << (8 * box); }  // rc_w1: request completed
constexpr std::uint32_t txok(std::size_t box) {
  return 1u << (8 * box + 1);
}  // rc_w1: transmission
   // succeeded
constexpr std::uint32_t terr(std::size_t box) { return 1u << (8 * box + 3); }  // rc_w1: transmission failed
constexpr std::uint32_t abrq(std::size_t box) { return 1u << (8 * box + 7); }  // rs: abort request
constexpr std::uint32_t tme(std::size_t box) { return 1u << (26 + box); }      // r: mailbox empty
inline constexpr std::uint32_t kAllCompleted = rqcp(0) | rqcp(1) | rqcp(2);
inline constexpr std::uint32_t kAbortAll = abrq(0) | abrq(1) | abrq(2);
}  // namespace tsr

namespace rf0r {
inline constexpr std::uint32_t kLevel = 0x3;        // r: FMP0, number of frames in the FIFO, 0..3
inline constexpr std::uint32_t kFull = 1u << 3;     // rc_w1
inline constexpr std::uint32_t kOverrun = 1u << 4;  // rc_w1: a frame was lost
inline constexpr std::uint32_t kRelease = 1u << 5;  // rs: RFOM0, release the oldest frame
}  // namespace rf0r

namespace ier {
inline constexpr std::uint32_t kTmeie = 1u << 0;   // interrupt while any RQCP is set
inline constexpr std::uint32_t kFmpie0 = 1u << 1;  // interrupt while FIFO 0 holds a frame
}  // namespace ier

namespace esr {
inline constexpr std::uint32_t kEwgf = 1u << 0;  // r: warning, an error count of at least 96
inline constexpr std::uint32_t kEpvf = 1u << 1;  // r: error passive, an error count above 127
inline constexpr std::uint32_t kBoff = 1u << 2;  // r: bus-off
inline constexpr int kTecShift = 16;
inline constexpr int kRecShift = 24;
}  // namespace esr

namespace mailbox {
inline constexpr std::uint32_t kTxrq = 1u << 0;  // rs: request transmission
inline constexpr std::uint32_t kRtr = 1u << 1;   // remote frame
inline constexpr std::uint32_t kIde = 1u << 2;   // 29-bit identifier
inline constexpr int kStidShift = 21;
inline constexpr std::uint32_t kDlc = 0xF;
}  // namespace mailbox

namespace fmr {
inline constexpr std::uint32_t kFinit = 1u << 0;  // filter initialisation mode
}

}  // namespace koboshi::hal::stm32
