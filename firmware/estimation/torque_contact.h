#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/fixed/units.h"
#include "firmware/robot/model.h"

namespace koboshi::estimation {

// Evidence about the legs other than their angles.
struct LegEvidence {
  std::span<const std::int16_t> torques_permille{};  // of all joints, in any sign, or none
  bool walks = false;
  std::optional<hal::Side> swing{};  // the foot that the walk plans in the air now
  // The foot relative to which a walk asks for the motion of the centre of mass.
  std::optional<hal::Side> reference{};
  bool stands_still = false;  // by command: no motion plays
};

// Tells which feet bear a robot without sensors in its feet, from torques and time.
//
// In a walk the swing leg accelerates, and its torques are as large as those of the support leg. The time
// tells then: the foot that the plan has in the air is not in contact. At other times the torques tell. The
// effort of a leg is the sum of the magnitudes of its drives' torques, in permille of their rated torque,
// through a first-order low-pass. A leg in the air carries itself only, so that its share of both efforts is
// small:
//
//   effort += (sum - effort) / kSmoothing,   share = effort / (effort + effort of the other leg).
//
// A foot loses contact when its share falls below kLost, and has it again above kRegained. At least one foot
// is always in contact, and both are while the efforts are too small to tell: a robot that is limp or stands
// on straight legs.
class TorqueContact {
 public:
  // All by hand, 2026-11-27.
  static constexpr std::int32_t kSmoothing = 8;
  static constexpr std::int32_t kLost_permille = 250;
  static constexpr std::int32_t kRegained_permille = 350;
  // Sum of both efforts below which they are friction and noise.
  static constexpr std::int32_t kMinEffort_permille = 200;

  // The model must outlive it.
  explicit TorqueContact(const robot::RobotModel& model);

  // Takes the evidence of one cycle of 10 ms and returns which feet are in contact.
  [[gnu::cold]] const hal::BySide<bool>& update(const LegEvidence& evidence);

 private:
  static constexpr int kFractionBits = 8;  // of an effort

  void follow_torques();

  hal::BySide<std::uint32_t> joints_{};  // of each leg; bit i: joint i
  hal::BySide<std::int32_t> efforts_{};  // 2^-kFractionBits permille
  hal::BySide<bool> contacts_{true, true};
};

}  // namespace koboshi::estimation
