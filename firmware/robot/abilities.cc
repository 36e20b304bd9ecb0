#include "firmware/robot/abilities.h"

#include "firmware/robot/leg.h"

namespace koboshi::robot {

std::uint16_t lost_abilities(const RobotModel& model) {
  using enum JointRole;
  unsigned lost = 0;
  const auto lose = [&](Ability ability, bool is_lost) {
    if (is_lost) lost |= 1u << static_cast<unsigned>(ability);
  };
  const bool senses_contact = model.ankle_kind != hal::AnkleKind::kNone;
  const bool walks = can_walk(model);
  lose(Ability::kZmp, !model.measures_loads());
  lose(Ability::kFootLoads, !model.measures_loads());
  lose(Ability::kContactSensing, !senses_contact);
  lose(Ability::kEarlyTouchdown, !senses_contact || !walks);
  lose(Ability::kWalking, !walks);
  lose(Ability::kTurning, !walks || !can_turn(model));
  lose(Ability::kArmSwing, !walks || !model.find(kLeftShoulderPitch) || !model.find(kRightShoulderPitch));
  return static_cast<std::uint16_t>(lost);
}

}  // namespace koboshi::robot
