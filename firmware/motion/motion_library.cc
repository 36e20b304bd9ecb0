#include "firmware/motion/motion_library.h"

#include "firmware/fixed/contract.h"

namespace koboshi::motion {

MotionLibrary::MotionLibrary(const storage::Catalogue& factory, const storage::ItemStore& stored,
                             const robot::RobotModel& model)
    : factory_(factory), stored_(stored), model_(model) {
  by_role_.fill(kNone);
}

void MotionLibrary::load() {
  for (std::uint16_t number = 0; number < storage::kMaxMotions; ++number) {
    Motion motion;
    if (open(number, motion)) add(number, motion);
  }
}

void MotionLibrary::add(std::uint16_t number, const Motion& motion) {
  KOBOSHI_ASSERT(number < storage::kMaxMotions);
  valid_ |= 1u << number;
  for (std::size_t role = 0; role < by_role_.size(); ++role) {
    if (by_role_[role] == number) by_role_[role] = kNone;
    if (motion.name() == kMotionNames[role]) by_role_[role] = static_cast<std::uint8_t>(number);
  }
}

std::span<const std::byte> MotionLibrary::image(std::uint16_t number) const {
  const auto stored = stored_.find(storage::ItemKind::kMotion, number);
  return stored.empty() ? factory_.find(storage::ItemKind::kMotion, number) : stored;
}

bool MotionLibrary::open(std::uint16_t number, Motion& motion) const {
  if (number >= storage::kMaxMotions) return false;
  // One that was stored for another model makes way for the factory's.
  return Motion::open(stored_.find(storage::ItemKind::kMotion, number), model_, motion).ok() ||
         Motion::open(factory_.find(storage::ItemKind::kMotion, number), model_, motion).ok();
}

std::optional<std::uint16_t> MotionLibrary::number_of(Role role) const {
  const std::uint8_t number = by_role_[static_cast<std::size_t>(role)];
  if (number == kNone) return std::nullopt;
  return number;
}

}  // namespace koboshi::motion
