#include "firmware/canopen/sync.h"

namespace koboshi::canopen {
namespace {

constexpr std::uint8_t kLowestOverflow = 2;
constexpr std::uint8_t kHighestOverflow = 240;

}  // namespace

void Sync::load_defaults(bool producer, std::uint32_t period_us, bool by_owner) {
  *this = Sync();
  cob_id_ = kSyncCobId | (producer ? kSyncProducer : 0);
  period_us_ = period_us;
  if (by_owner) owners_period_us_ = period_us;
}

void Sync::start(std::uint64_t now_us) {
  produced_ = 0;
  counter_ = 0;
  last_us_ = now_us;
  due_us_ = now_us + period_us_;
}

AbortCode Sync::read(std::uint16_t index, ObjectValue& value) const {
  switch (index) {
    case 0x1005:
      value.set_number(cob_id_, 4);
      return AbortCode::kNone;
    case 0x1006:
      value.set_number(period_us_, 4);
      return AbortCode::kNone;
    case 0x1007:
      value.set_number(window_us_, 4);
      return AbortCode::kNone;
    case 0x1019:
      value.set_number(overflow_, 1);
      return AbortCode::kNone;
    default:
      return AbortCode::kObjectDoesNotExist;
  }
}

AbortCode Sync::write(std::uint16_t index, std::uint32_t value) {
  switch (index) {
    case 0x1005:
      return write_cob_id(value);
    case 0x1006:
      if (owners_period_us_ != 0 && value != 0 && value != owners_period_us_) return AbortCode::kInvalidValue;
      period_us_ = value;
      due_us_ = 0;  // the new period begins with the next `take_due`
      return AbortCode::kNone;
    case 0x1007:
      window_us_ = value;
      return AbortCode::kNone;
    case 0x1019:
      return write_overflow(value);
    default:
      return AbortCode::kObjectDoesNotExist;
  }
}

// The identifier does not change while it is in use (CiA 301, 7.5.2.5).
AbortCode Sync::write_cob_id(std::uint32_t value) {
  const auto identifier = static_cast<std::uint16_t>(value & kCobIdMask);
  if ((value & kCobIdExtended) != 0 || is_restricted(identifier)) return AbortCode::kInvalidValue;
  if (producer() && identifier != (cob_id_ & kCobIdMask)) return AbortCode::kInvalidValue;
  const bool begins = !producer() && (value & kSyncProducer) != 0;
  cob_id_ = identifier | (value & kSyncProducer);
  if (begins) produced_ = 0;
  return AbortCode::kNone;
}

// Not while SYNCs are being counted (CiA 301, 7.5.2.22).
AbortCode Sync::write_overflow(std::uint32_t value) {
  if (period_us_ != 0) return AbortCode::kDeviceState;
  if (value != 0 && (value < kLowestOverflow || value > kHighestOverflow)) return AbortCode::kInvalidValue;
  overflow_ = static_cast<std::uint8_t>(value);
  produced_ = 0;
  return AbortCode::kNone;
}

bool Sync::accept(const hal::CanFrame& frame, std::uint64_t now_us) {
  if (frame.size != (overflow_ != 0 ? 1 : 0)) return false;
  counter_ = frame.size != 0 ? frame.data[0] : std::uint8_t{0};
  last_us_ = now_us;
  return true;
}

bool Sync::take_beat(std::uint64_t now_us) {
  if (now_us < due_us_) return false;
  due_us_ = next_beat(due_us_, period_us_, now_us);
  return true;
}

hal::CanFrame Sync::next() {
  hal::CanFrame frame{.identifier = identifier()};
  if (overflow_ == 0) return frame;
  produced_ = produced_ < overflow_ ? static_cast<std::uint8_t>(produced_ + 1) : std::uint8_t{1};
  frame.size = 1;
  frame.data[0] = produced_;
  return frame;
}

}  // namespace koboshi::canopen
