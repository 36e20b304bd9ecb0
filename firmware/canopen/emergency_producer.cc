#include "firmware/canopen/emergency_producer.h"

namespace koboshi::canopen {

void EmergencyProducer::load_defaults(std::uint8_t node_id) {
  cob_id_ = static_cast<std::uint32_t>(kEmergencyBase + node_id);
  inhibit_time_100us_ = 0;
  inhibited_until_us_ = 0;
  clear();
}

AbortCode EmergencyProducer::write_cob_id(std::uint32_t value) {
  const AbortCode checked = check_cob_id(cob_id_, value);
  if (checked != AbortCode::kNone) return checked;
  cob_id_ = value;
  if ((value & kCobIdInvalid) != 0) clear();
  return AbortCode::kNone;
}

void EmergencyProducer::send(const Emergency& emergency) {
  if ((cob_id_ & kCobIdInvalid) != 0) return;
  if (inhibit_time_100us_ == 0 && size_ == 0) return transmit(emergency);
  if (size_ == pending_.size()) return;
  pending_[(first_ + size_) % pending_.size()] = emergency;
  ++size_;
}

void EmergencyProducer::send_pending(std::uint64_t now_us) {
  while (size_ > 0 && now_us >= inhibited_until_us_) {
    transmit(pending_[first_]);
    first_ = (first_ + 1) % pending_.size();
    --size_;
    inhibited_until_us_ = now_us + inhibit_time_100us_ * 100u;
  }
}

void EmergencyProducer::transmit(const Emergency& emergency) {
  hal::CanFrame frame = encode(emergency);
  frame.identifier = static_cast<std::uint16_t>(cob_id_ & kCobIdMask);
  static_cast<void>(sink_.send(frame));
}

}  // namespace koboshi::canopen
