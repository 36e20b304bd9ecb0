#include "firmware/motion/motion_library.h"

#include "firmware/fixed/contract.h"

namespace koboshi::motion {

MotionLibrary::MotionLibrary(const storage::Catalogue& factory, storage::ItemStore& stored,
                             const robot::RobotModel& model)
    : factory_(factory), stored_(stored), model_(model) {
  by_role_.fill(kNone);
}

void MotionLibrary::load() {
  for (std::uint16_t number = 0; number < storage::kMaxMotions; ++number) {
    Motion motion;
    if (open(number, motion)) add(number, motion);
  }
  searched_ = storage::kMaxMotions;
}

void MotionLibrary::add(std::uint16_t number, const Motion& motion) {
  remove(number);
  valid_[number / 32u] |= 1u << number % 32u;
  for (std::size_t role = 0; role < by_role_.size(); ++role) {
    if (motion.name() == kMotionNames[role]) by_role_[role] = static_cast<std::uint8_t>(number);
  }
}

void MotionLibrary::remove(std::uint16_t number) {
  KOBOSHI_ASSERT(number < storage::kMaxMotions);
  valid_[number / 32u] &= ~(1u << number % 32u);
  for (std::uint8_t& by_role : by_role_) {
    if (by_role != number) continue;
    by_role = kNone;
    searched_ = 0;
  }
}

storage::Status MotionLibrary::erase(std::uint16_t number) {
  const storage::Status status = stored_.erase(storage::ItemKind::kMotion, number);
  if (status != storage::Status::kOk) return status;
  Motion factory;
  if (open(number, factory)) {
    add(number, factory);
  } else {
    remove(number);
  }
  return status;
}

// Checks one motion per call, because a check of all of them takes many milliseconds.
void MotionLibrary::search_next() {
  Motion motion;
  const std::uint16_t number = searched_++;
  if (!open(number, motion)) return;
  for (std::size_t role = 0; role < by_role_.size(); ++role) {
    if (by_role_[role] == kNone && motion.name() == kMotionNames[role])
      by_role_[role] = static_cast<std::uint8_t>(number);
  }
}

std::span<const std::byte> MotionLibrary::image(std::uint16_t number) const {
  const auto stored = stored_.find(storage::ItemKind::kMotion, number);
  return stored.empty() ? factory_.find(storage::ItemKind::kMotion, number) : stored;
}

// Falls back to the factory's motion if the stored one is for another model.
std::span<const std::byte> MotionLibrary::open_image(std::uint16_t number, Motion& motion) const {
  if (number >= storage::kMaxMotions) return {};
  for (const auto image : {stored_.find(storage::ItemKind::kMotion, number),
                           factory_.find(storage::ItemKind::kMotion, number)}) {
    if (Motion::open(image, model_, motion).ok()) return image;
  }
  return {};
}

bool MotionLibrary::open_to_play(storage::Holder player, std::uint16_t number, Motion& motion) {
  const auto image = open_image(number, motion);
  if (image.empty()) return false;
  stored_.pin(player, image);
  return true;
}

std::optional<std::uint16_t> MotionLibrary::number_of(Role role) const {
  const std::uint8_t number = by_role_[static_cast<std::size_t>(role)];
  if (number == kNone) return std::nullopt;
  return number;
}

}  // namespace koboshi::motion
