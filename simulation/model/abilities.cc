#include "simulation/model/abilities.h"

#include <array>
#include <cstddef>

namespace koboshi::simulation {
namespace {

struct AbilityText {
  const char* name;
  const char* found;
  const char* expected;
};

// By robot::Ability.
constexpr std::array<AbilityText, robot::kAbilities> kTexts{{
    {"zmp", "feet that measure no pressure, so the ZMP is invalid",
     "sensors of type force_torque or koboshi:pressure_cells in both ankles"},
    {"foot_loads", "feet that measure no load, so a foot in contact bears the weight or half of it",
     "sensors of type force_torque or koboshi:pressure_cells in both ankles"},
    {"contact_sensing", "feet without sensors, so contact is derived from the torques of the legs",
     "a sensor of any type in both ankles"},
    {"early_touchdown", "no sensed contact of a walking foot, so steps end by time alone",
     "a sensor of any type in both ankles, and legs that walk"},
    {"walking", "legs that cannot walk",
     "legs with hip_roll, hip_pitch, knee, ankle_pitch and ankle_roll, from the base down, as names or roles "
     "(koboshi model map proposes roles)"},
    {"turning", "legs that cannot turn the robot while it walks",
     "legs that walk, with hip_yaw; one motor for both has to turn the feet against each other"},
    {"arm_swing", "arms that cannot swing while the robot walks",
     "shoulder_pitch on both sides, and legs that walk"},
}};

}  // namespace

std::vector<LostAbility> find_lost_abilities(const robot::RobotModel& model) {
  const unsigned lost = robot::lost_abilities(model);
  std::vector<LostAbility> abilities;
  for (std::size_t i = 0; i < kTexts.size(); ++i) {
    if ((lost >> i & 1u) == 0) continue;
    const AbilityText& text = kTexts[i];
    abilities.push_back({static_cast<robot::Ability>(i), text.name, text.found, text.expected});
  }
  return abilities;
}

}  // namespace koboshi::simulation
