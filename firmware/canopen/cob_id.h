#pragma once

#include <cstdint>

#include "firmware/canopen/abort_code.h"

namespace koboshi::canopen {

inline constexpr std::uint8_t kMaxNodeId = 127;
inline constexpr std::uint8_t kUnconfiguredNodeId = 0xFF;  // until LSS gives one (CiA 305)

// Predefined connection set (CiA 301, 7.3.5): the identifier is the base plus the node's id. A "T" is seen
// from the node.
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

// Whether a COB-ID object may go from `present` to `wanted`. The identifier changes only while bit 31 says
// that there is none (CiA 301, 7.5.2.17, 7.5.2.33, 7.5.2.35), the bits of `flags` change at any time; others
// are refused.
constexpr AbortCode check_cob_id(std::uint32_t present, std::uint32_t wanted, std::uint32_t flags = 0) {
  const bool valid = (wanted & kCobIdInvalid) == 0;
  const bool was_valid = (present & kCobIdInvalid) == 0;
  if ((wanted & ~(kCobIdInvalid | kCobIdMask | flags)) != 0) return AbortCode::kInvalidValue;
  if (valid && is_restricted(static_cast<std::uint16_t>(wanted & kCobIdMask)))
    return AbortCode::kInvalidValue;
  if (valid && was_valid && ((wanted ^ present) & ~flags) != 0) return AbortCode::kInvalidValue;
  return AbortCode::kNone;
}

}  // namespace koboshi::canopen
