#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/motion/motion.h"
#include "firmware/motion/roles.h"
#include "firmware/storage/catalogue.h"
#include "firmware/storage/item_store.h"

namespace koboshi::motion {

// The motions that the robot has: those of the factory's catalogue, and those that were stored since, which
// take their place. Numbers go from 0 to kMaxMotions - 1.
//
// A motion is validated once: at boot, or when it is added. The library keeps what the validation has found
// (Motion::Findings), and the store marks the item as validated until its bytes change. A motion with a mark
// opens in a bounded time; one without, such as an upload that was cut off in its last millisecond, is
// validated whenever it is opened. The factory's motions do not change between two boots.
class MotionLibrary {
 public:
  // Bit b of element i: there is a motion 32 i + b that this robot can play.
  using Mask = std::array<std::uint32_t, (storage::kMaxMotions + 31) / 32>;

  // All must outlive the library.
  MotionLibrary(const storage::Catalogue& factory, storage::ItemStore& stored,
                const robot::RobotModel& model);

  // Validates all motions in storage: some 10^5 instructions of the Cortex-M4 for a large one.
  void load();
  // Adds a motion that is new under its number: the one that is stored now, and that `motion` has opened. Of
  // two with the same name the one that came last has its role.
  void add(std::uint16_t number, const Motion& motion);
  // Erases the stored motion of a number; that of the factory takes its place, if there is one. To be
  // repeated while it returns kBusy.
  storage::Status erase(std::uint16_t number);
  // Gives roles that lost their motion to another of this name. To be called once a millisecond.
  void process() {
    if (searched_ < storage::kMaxMotions) search_next();
  }

  // The bytes under a number, valid or not; empty: none.
  std::span<const std::byte> image(std::uint16_t number) const;
  // Returns the image of a motion that this robot can play, and sets `motion`; empty when there is none under
  // that number.
  std::span<const std::byte> open_image(std::uint16_t number, Motion& motion) const;
  [[nodiscard]] bool open(std::uint16_t number, Motion& motion) const {
    return !open_image(number, motion).empty();
  }
  // The same, to play it: its bytes stay, whatever is stored meanwhile, until this player opens another or
  // closes it.
  [[nodiscard]] bool open_to_play(storage::Holder player, std::uint16_t number, Motion& motion);
  void close(storage::Holder player) { stored_.unpin(player); }
  std::optional<std::uint16_t> number_of(Role role) const;
  const Mask& valid() const { return valid_; }

 private:
  static constexpr std::uint8_t kNone = 0xFF;
  static_assert(storage::kMaxMotions <= kNone);

  static bool contains(const Mask& mask, std::uint16_t number) {
    return (mask[number / 32u] >> number % 32u & 1u) != 0;
  }
  std::span<const std::byte> validate(std::uint16_t number, Motion& motion) const;
  void validate_again(std::uint16_t number);
  void keep(std::uint16_t number, const Motion& motion, bool is_stored);
  bool is_validated(std::uint16_t number) const;
  void remove(std::uint16_t number);
  void search_next();

  const storage::Catalogue& factory_;
  storage::ItemStore& stored_;
  const robot::RobotModel& model_;
  Mask valid_{};
  Mask stored_valid_{};  // those of `valid_` that are in `stored_`
  std::array<std::uint32_t, storage::kMaxMotions> claimed_joints_{};  // Motion::Findings of valid motions
  std::array<std::uint16_t, storage::kMaxMotions> main_step_counts_{};
  std::array<std::uint8_t, kMotionNames.size()> by_role_;
  std::uint16_t searched_ = storage::kMaxMotions;  // for roles without a motion
};

}  // namespace koboshi::motion
