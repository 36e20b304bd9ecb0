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
  walker_.advance(velocity_, {.roll = robot.roll,
                              .pitch = robot.pitch,
                              .rates = robot.rates_B,
                              .loads = {robot.feet[0].load, robot.feet[1].load}});
  std::ranges::copy(walker_.targets(), targets.begin());
}

}  // namespace koboshi::behaviour
