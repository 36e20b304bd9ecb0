#include "firmware/canopen/emergency.h"

#include <algorithm>

namespace koboshi::canopen {

bool ErrorLog::active(std::uint16_t code) const {
  const auto end = active_.begin() + active_size_;
  return std::any_of(active_.begin(), end, [code](const Active& error) { return error.code == code; });
}

bool ErrorLog::raise(std::uint16_t code, std::uint8_t register_bits, std::uint16_t additional,
                     ErrorReporter reporter) {
  const auto bit = static_cast<std::uint8_t>(reporter);
  const auto end = active_.begin() + active_size_;
  const auto known = std::find_if(active_.begin(), end, [code](const Active& e) { return e.code == code; });
  if (known != end) {
    known->reporters |= bit;
    return false;
  }
  if (active_size_ < kMaxActive) active_[active_size_++] = {code, register_bits, bit};
  update_register();
  record(code, additional);
  return true;
}

void ErrorLog::record(std::uint16_t code, std::uint16_t additional) {
  std::copy_backward(history_.begin(), history_.end() - 1, history_.end());
  history_[0] = code | (static_cast<std::uint32_t>(additional) << 16);
  if (history_size_ < kHistory) ++history_size_;
}

bool ErrorLog::withdraw(std::uint16_t code, ErrorReporter reporter) {
  const auto end = active_.begin() + active_size_;
  const auto known = std::find_if(active_.begin(), end, [code](const Active& e) { return e.code == code; });
  if (known == end) return false;
  known->reporters &= static_cast<std::uint8_t>(~static_cast<unsigned>(reporter));
  if (known->reporters != 0) return false;
  std::copy(known + 1, end, known);
  --active_size_;
  update_register();
  return true;
}

void ErrorLog::update_register() {
  register_ = active_size_ > 0 ? error_register::kGeneric : 0;
  for (std::size_t i = 0; i < active_size_; ++i) register_ |= active_[i].register_bits;
}

AbortCode ErrorLog::read_history(std::uint8_t subindex, ObjectValue& value) const {
  if (subindex > kHistory) return AbortCode::kSubindexDoesNotExist;
  if (subindex > history_size_) return AbortCode::kNoData;
  if (subindex == 0) {
    value.set_number(history_size_, 1);
  } else {
    value.set_number(history_[subindex - 1u], 4);
  }
  return AbortCode::kNone;
}

AbortCode ErrorLog::write_history(std::uint8_t subindex, std::uint32_t value) {
  if (subindex > kHistory) return AbortCode::kSubindexDoesNotExist;
  if (subindex != 0) return AbortCode::kWriteOfReadOnly;
  if (value != 0) return AbortCode::kInvalidValue;
  history_size_ = 0;
  return AbortCode::kNone;
}

// --- Producer

void EmergencyProducer::load_defaults(std::uint8_t node_id) {
  cob_id_ = static_cast<std::uint32_t>(kEmergencyBase + node_id);
  inhibit_time_100us_ = 0;
  sent_us_.reset();
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
  const std::uint64_t inhibit_us = inhibit_time_100us_ * 100u;
  while (size_ > 0 && (!sent_us_ || now_us >= *sent_us_ + inhibit_us)) {
    transmit(pending_[first_]);
    first_ = (first_ + 1) % pending_.size();
    --size_;
    sent_us_ = now_us;
  }
}

void EmergencyProducer::transmit(const Emergency& emergency) {
  hal::CanFrame frame = encode(emergency);
  frame.identifier = static_cast<std::uint16_t>(cob_id_ & kCobIdMask);
  static_cast<void>(sink_.send(frame));
}

}  // namespace koboshi::canopen
