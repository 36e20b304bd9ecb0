#pragma once

#include <array>
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
class MotionLibrary {
 public:
  // All must outlive the library.
  MotionLibrary(const storage::Catalogue& factory, const storage::ItemStore& stored,
                const robot::RobotModel& model);

  // Looks through storage, which takes as long as checking all motions does.
  void load();
  // A motion that is new under its number. Of two with the same name the one that came last has its role.
  void add(std::uint16_t number, const Motion& motion);

  // The bytes under a number, valid or not; empty: none.
  std::span<const std::byte> image(std::uint16_t number) const;
  // False when there is no motion under that number which this robot can play.
  [[nodiscard]] bool open(std::uint16_t number, Motion& motion) const;
  std::optional<std::uint16_t> number_of(Role role) const;
  // Bit n: there is a motion n that this robot can play.
  std::uint32_t valid() const { return valid_; }

 private:
  static constexpr std::uint8_t kNone = 0xFF;

  const storage::Catalogue& factory_;
  const storage::ItemStore& stored_;
  const robot::RobotModel& model_;
  std::uint32_t valid_ = 0;
  std::array<std::uint8_t, kMotionNames.size()> by_role_;
};

}  // namespace koboshi::motion
