#include "firmware/canopen/time_stamp.h"

namespace koboshi::canopen {
namespace {

constexpr std::uint8_t kSize = 6;
constexpr std::uint32_t kMillisecondBits = 0x0FFF'FFFF;

}  // namespace

AbortCode TimeStamp::write_cob_id(std::uint32_t value) {
  const auto identifier = static_cast<std::uint16_t>(value & kCobIdMask);
  const bool consumes = (value & kTimeConsumer) != 0;
  if ((value & ~(kTimeConsumer | kCobIdMask)) != 0) return AbortCode::kInvalidValue;
  if (consumes && is_restricted(identifier)) return AbortCode::kInvalidValue;
  const bool in_use = consumes && (cob_id_ & kTimeConsumer) != 0;
  if (in_use && identifier != (cob_id_ & kCobIdMask)) return AbortCode::kInvalidValue;
  cob_id_ = value;
  return AbortCode::kNone;
}

bool TimeStamp::accept(const hal::CanFrame& frame, std::uint64_t now_us) {
  const TimeOfDay told{load_u32(&frame.data[0]) & kMillisecondBits, load_u16(&frame.data[4])};
  if (frame.size != kSize || told.ms >= kMillisecondsADay) return false;
  last_ = told;
  last_us_ = now_us;
  return true;
}

std::optional<TimeOfDay> TimeStamp::at(std::uint64_t now_us) const {
  if (!last_) return std::nullopt;
  const std::uint64_t ms = last_->ms + (now_us - last_us_) / 1000;
  return TimeOfDay{static_cast<std::uint32_t>(ms % kMillisecondsADay),
                   static_cast<std::uint16_t>(last_->days + ms / kMillisecondsADay)};
}

}  // namespace koboshi::canopen
