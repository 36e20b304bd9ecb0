#pragma once

#include <cstdint>
#include <optional>

#include "firmware/canopen/abort_code.h"
#include "firmware/canopen/cob_id.h"
#include "firmware/canopen/frame.h"

namespace koboshi::canopen {

// TIME_OF_DAY (CiA 301, 7.1.6.5).
struct TimeOfDay {
  std::uint32_t ms = 0;    // after midnight, 28 bits
  std::uint16_t days = 0;  // since 1 January 1984

  friend bool operator==(const TimeOfDay&, const TimeOfDay&) = default;
};

inline constexpr std::uint32_t kMillisecondsADay = 86'400'000;
inline constexpr std::uint16_t kTimeCobId = 0x100;
inline constexpr std::uint32_t kTimeConsumer = 1u << 31;  // of 0x1012
inline constexpr std::uint32_t kTimeProducer = 1u << 30;  // of 0x1012; this stack refuses it

// The consumer of the TIME object (CiA 301, 7.2.6) and 0x1012, COB-ID time stamp object. Between two messages
// the time goes on by the node's own clock.
class TimeStamp {
 public:
  // As after a reset. What is known of the time stays.
  void load_defaults() { cob_id_ = kTimeConsumer | kTimeCobId; }
  std::uint32_t cob_id() const { return cob_id_; }
  // The identifier does not change while bit 31 is set.
  AbortCode write_cob_id(std::uint32_t value);

  bool identifies(const hal::CanFrame& frame) const {
    return (cob_id_ & kTimeConsumer) != 0 && frame.identifier == (cob_id_ & kCobIdMask);
  }
  // Notes the time of a TIME message. False when it is none: another length than six bytes, or no time of
  // day.
  bool accept(const hal::CanFrame& frame, std::uint64_t now_us);
  // The time of day; nothing before the first message.
  std::optional<TimeOfDay> at(std::uint64_t now_us) const;

 private:
  std::uint32_t cob_id_ = kTimeConsumer | kTimeCobId;
  std::optional<TimeOfDay> last_;
  std::uint64_t last_us_ = 0;
};

}  // namespace koboshi::canopen
