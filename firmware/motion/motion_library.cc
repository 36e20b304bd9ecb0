#include "firmware/motion/motion_library.h"

#include "firmware/fixed/contract.h"

namespace koboshi::motion {

MotionLibrary::MotionLibrary(const storage::Catalogue& factory, storage::ItemStore& stored,
                             const robot::RobotModel& model)
    : factory_(factory), stored_(stored), model_(model) {
  by_role_.fill(kNone);
}

void MotionLibrary::load() {
  for (std::uint16_t number = 0; number < storage::kMaxMotions; ++number) validate_again(number);
  searched_ = storage::kMaxMotions;
}

void MotionLibrary::add(std::uint16_t number, const Motion& motion) {
  keep(number, motion, true);
  stored_.mark(storage::ItemKind::kMotion, number);
}

void MotionLibrary::keep(std::uint16_t number, const Motion& motion, bool is_stored) {
  remove(number);
  const std::uint32_t bit = 1u << number % 32u;
  valid_[number / 32u] |= bit;
  if (is_stored) stored_valid_[number / 32u] |= bit;
  const Motion::Findings findings = motion.findings();
  claimed_joints_[number] = findings.claimed_joints;
  main_step_counts_[number] = findings.main_step_count;
  for (std::size_t role = 0; role < by_role_.size(); ++role) {
    if (motion.name() == kMotionNames[role]) by_role_[role] = static_cast<std::uint8_t>(number);
  }
}

void MotionLibrary::remove(std::uint16_t number) {
  KOBOSHI_ASSERT(number < storage::kMaxMotions);
  valid_[number / 32u] &= ~(1u << number % 32u);
  stored_valid_[number / 32u] &= ~(1u << number % 32u);
  for (std::uint8_t& by_role : by_role_) {
    if (by_role != number) continue;
    by_role = kNone;
    searched_ = 0;
  }
}

storage::Status MotionLibrary::erase(std::uint16_t number) {
  const storage::Status status = stored_.erase(storage::ItemKind::kMotion, number);
  if (status != storage::Status::kOk) return status;
  validate_again(number);
  return status;
}

// Looks at one motion per call.
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
std::span<const std::byte> MotionLibrary::validate(std::uint16_t number, Motion& motion) const {
  for (const auto image : {stored_.find(storage::ItemKind::kMotion, number),
                           factory_.find(storage::ItemKind::kMotion, number)}) {
    if (Motion::open(image, model_, motion).ok()) return image;
  }
  return {};
}

void MotionLibrary::validate_again(std::uint16_t number) {
  Motion motion;
  const auto image = validate(number, motion);
  if (image.empty()) {
    remove(number);
  } else {
    keep(number, motion, image.data() == stored_.find(storage::ItemKind::kMotion, number).data());
  }
  stored_.mark(storage::ItemKind::kMotion, number);
}

// Whether what is known of this number is about the bytes that are stored now.
bool MotionLibrary::is_validated(std::uint16_t number) const {
  return stored_.find(storage::ItemKind::kMotion, number).empty()
             ? !contains(stored_valid_, number)
             : stored_.marked(storage::ItemKind::kMotion, number);
}

std::span<const std::byte> MotionLibrary::open_image(std::uint16_t number, Motion& motion) const {
  if (number >= storage::kMaxMotions) return {};
  if (!is_validated(number)) return validate(number, motion);
  if (!contains(valid_, number)) return {};
  const auto image = contains(stored_valid_, number) ? stored_.find(storage::ItemKind::kMotion, number)
                                                     : factory_.find(storage::ItemKind::kMotion, number);
  motion = Motion::reopen(image, {claimed_joints_[number], main_step_counts_[number]});
  return image;
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
