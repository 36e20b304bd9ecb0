#include "firmware/app/motion_index.h"

namespace koboshi::app {

void MotionIndex::add(std::uint16_t number, const motion::Motion& motion) {
  valid_ |= 1u << number;
  for (std::size_t role = 0; role < by_role_.size(); ++role) {
    if (by_role_[role] == number) by_role_[role] = kNone;
    if (motion.name() == recovery::kMotionNames[role]) by_role_[role] = static_cast<std::uint8_t>(number);
  }
}

std::optional<std::uint16_t> MotionIndex::number_of(recovery::Role role) const {
  const std::uint8_t number = by_role_[static_cast<std::size_t>(role)];
  if (number == kNone) return std::nullopt;
  return number;
}

}  // namespace koboshi::app
