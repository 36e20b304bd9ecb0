#include "firmware/storage/motion_library.h"

#include "firmware/fixed/contract.h"

namespace koboshi::storage {

MotionLibrary::MotionLibrary(const Catalogue& factory, const ItemStore& stored,
                             const robot::RobotModel& model)
    : factory_(factory), stored_(stored), model_(model) {
  by_role_.fill(kNone);
}

void MotionLibrary::load() {
  for (std::uint16_t number = 0; number < kMaxMotions; ++number) {
    motion::Motion motion;
    if (open(number, motion)) add(number, motion);
  }
}

void MotionLibrary::add(std::uint16_t number, const motion::Motion& motion) {
  KOBOSHI_ASSERT(number < kMaxMotions);
  valid_ |= 1u << number;
  for (std::size_t role = 0; role < by_role_.size(); ++role) {
    if (by_role_[role] == number) by_role_[role] = kNone;
    if (motion.name() == motion::kMotionNames[role]) by_role_[role] = static_cast<std::uint8_t>(number);
  }
}

std::span<const std::byte> MotionLibrary::image(std::uint16_t number) const {
  const auto stored = stored_.find(ItemKind::kMotion, number);
  return stored.empty() ? factory_.find(ItemKind::kMotion, number) : stored;
}

bool MotionLibrary::open(std::uint16_t number, motion::Motion& motion) const {
  if (number >= kMaxMotions) return false;
  // One that was stored for another model makes way for the factory's.
  return motion::Motion::open(stored_.find(ItemKind::kMotion, number), model_, motion).ok() ||
         motion::Motion::open(factory_.find(ItemKind::kMotion, number), model_, motion).ok();
}

std::optional<std::uint16_t> MotionLibrary::number_of(motion::Role role) const {
  const std::uint8_t number = by_role_[static_cast<std::size_t>(role)];
  if (number == kNone) return std::nullopt;
  return number;
}

}  // namespace koboshi::storage
