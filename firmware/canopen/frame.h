#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/canopen/dictionary.h"
#include "hal/port/can.h"

// NMT (CiA 301, 7.2.8), heartbeat (7.2.8.3.2) and emergency messages (7.2.7) as CAN frames; and the
// identifiers of the predefined connection set (7.3.5).
namespace koboshi::canopen {

// States of a node, with the values that its heartbeat carries (CiA 301, 7.3.2.2). kInitialising appears as
// the boot-up message.
enum class NmtState : std::uint8_t {
  kInitialising = 0,
  kStopped = 4,
  kOperational = 5,
  kPreOperational = 127
};

// Commands of the NMT master (CiA 301, 7.2.8.2.1).
enum class NmtCommand : std::uint8_t {
  kStart = 1,
  kStop = 2,
  kEnterPreOperational = 128,
  kResetNode = 129,
  kResetCommunication = 130,
};

// Which services a state permits (CiA 301, 7.3.2.2.5).
constexpr bool permits_pdo(NmtState state) { return state == NmtState::kOperational; }
constexpr bool permits_sdo(NmtState state) {
  return state == NmtState::kOperational || state == NmtState::kPreOperational;
}
constexpr bool permits_sync(NmtState state) { return permits_sdo(state); }
constexpr bool permits_time(NmtState state) { return permits_sdo(state); }
constexpr bool permits_emergency(NmtState state) { return permits_sdo(state); }

inline constexpr std::uint8_t kMaxNodeId = 127;
inline constexpr std::uint8_t kUnconfiguredNodeId = 0xFF;  // until LSS assigns one (CiA 305)

// Predefined connection set (CiA 301, 7.3.5): the identifier is the base plus the node id. The node transmits
// TPDOs and receives RPDOs.
inline constexpr std::uint16_t kFunctionCodeMask = 0x780;
inline constexpr std::uint16_t kNmtCobId = 0x000;
inline constexpr std::uint16_t kSyncCobId = 0x080;
inline constexpr std::uint16_t kEmergencyBase = 0x080;
inline constexpr std::uint16_t kTpdo1Base = 0x180;
inline constexpr std::uint16_t kRpdo1Base = 0x200;
inline constexpr std::uint16_t kPdoStep = 0x100;  // from PDO n to PDO n + 1, of 1..4
inline constexpr std::uint16_t kSdoResponseBase = 0x580;
inline constexpr std::uint16_t kSdoRequestBase = 0x600;
inline constexpr std::uint16_t kHeartbeatBase = 0x700;

// Flags of the COB-ID objects (CiA 301, 7.5.2.5, 7.5.2.35, 7.5.2.37).
inline constexpr std::uint32_t kCobIdInvalid = 1u << 31;   // the PDO or EMCY does not exist
inline constexpr std::uint32_t kCobIdNoRemote = 1u << 30;  // of a TPDO: no answer to remote frames
inline constexpr std::uint32_t kCobIdExtended = 1u << 29;  // 29-bit identifier; this stack refuses it
inline constexpr std::uint32_t kSyncProducer = 1u << 30;   // of 0x1005: this node produces SYNC
inline constexpr std::uint32_t kCobIdMask = 0x7FF;

// Identifiers that no configuration may choose (CiA 301, table 40).
constexpr bool is_restricted(std::uint16_t identifier) {
  return identifier <= 0x07F || (identifier >= 0x101 && identifier <= 0x180) ||
         (identifier >= 0x581 && identifier <= 0x5FF) || (identifier >= 0x601 && identifier <= 0x67F) ||
         identifier >= 0x6E0;
}

// Checks whether a COB-ID object may change from `present` to `wanted`. The identifier may change only while
// bit 31 marks it invalid (CiA 301, 7.5.2.17, 7.5.2.33, 7.5.2.35), the bits of `flags` at any time, and no
// other bits.
constexpr AbortCode check_cob_id(std::uint32_t present, std::uint32_t wanted, std::uint32_t flags = 0) {
  const bool valid = (wanted & kCobIdInvalid) == 0;
  const bool was_valid = (present & kCobIdInvalid) == 0;
  if ((wanted & ~(kCobIdInvalid | kCobIdMask | flags)) != 0) return AbortCode::kInvalidValue;
  if (valid && is_restricted(static_cast<std::uint16_t>(wanted & kCobIdMask)))
    return AbortCode::kInvalidValue;
  if (valid && was_valid && ((wanted ^ present) & ~flags) != 0) return AbortCode::kInvalidValue;
  return AbortCode::kNone;
}

// Where the parts of the stack send their frames.
class FrameSink {
 public:
  // Sends a frame; false, and nothing sent, when there is no room.
  [[nodiscard]] virtual bool send(const hal::CanFrame& frame) = 0;
  // Whether a frame of this FIFO still waits for the bus, as far as is known.
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

// An emergency message (CiA 301, 7.2.7). Code 0x0000: an error has ended.
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

// Decode a frame; nullopt if it is not such a message: wrong identifier, length, command or state, or a
// remote frame.
std::optional<NmtMessage> decode_nmt(const hal::CanFrame& frame);
std::optional<Emergency> decode_emergency(const hal::CanFrame& frame);
std::optional<Heartbeat> decode_heartbeat(const hal::CanFrame& frame);

}  // namespace koboshi::canopen
