#include "firmware/behaviour/commanded_walk.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "hal/port/period.h"

namespace koboshi::behaviour {

std::uint32_t CommandedWalk::joints() const { return model_.leg_joints(); }

void CommandedWalk::advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
                            std::span<fixed::Angle> targets) {
  KOBOSHI_ASSERT(elapsed_us == hal::kControlPeriod_us);
  const estimation::RobotState& robot = inputs.robot;
  // Contacts from the torques of the legs come too late for a touchdown.
  const bool senses_contact = model_.ankle_kind != hal::AnkleKind::kNone;
  const auto load = [&](std::size_t foot) { return senses_contact ? robot.feet[foot].load : fixed::Force(); };
  walker_.advance(velocity_, {.roll = robot.roll,
                              .pitch = robot.pitch,
                              .rates = robot.rates_B,
                              .loads = {load(0), load(1)},
                              .angles = inputs.angles});
  std::ranges::copy(walker_.targets(), targets.begin());
}

}  // namespace koboshi::behaviour
