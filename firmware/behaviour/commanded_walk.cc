#include "firmware/behaviour/commanded_walk.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "hal/port/period.h"

namespace koboshi::behaviour {

namespace {

std::optional<walk::MeasuredDcm> measured_dcm(const estimation::CentreOfMassMotion& com) {
  if (!com.valid) return std::nullopt;
  return walk::MeasuredDcm{.p = {com.dcm.x, com.dcm.y}, .sole = com.sole};
}

}  // namespace

std::uint32_t CommandedWalk::joints() const { return model_.leg_joints(); }

// A robot that is carried is not pushed. On a slope, or with a load that its model does not have, the centre
// of mass of a robot at rest is off the ZMP by a centimetre or two: only one that moves on, by half of the
// limit in a time constant of the pendulum, is pushed. A push to the side, which the soles hold where one
// ahead would throw the robot over, also swings it ahead by a few millimetres: it counts only where it is
// less than twice that.
std::optional<hal::Side> CommandedWalk::needed(const walk::WalkParameters& parameters,
                                               const estimation::RobotState& robot) {
  const fixed::Length most = walk::tenths_of_mm(parameters.reaction.max_standing_dcm);
  if (most == fixed::Length() || !robot.com.valid || !robot.contacts[robot.com.sole].touches)
    return std::nullopt;
  const fixed::Length ahead = robot.com.dcm.x - walk::tenths_of_mm(parameters.posture.zmp_forward);
  const fixed::Length moving = robot.com.dcm.x - robot.com.position.x;
  const bool moves_on = (ahead > fixed::Length() ? moving : -moving) > most / 2;
  const fixed::Length half_width = walk::tenths_of_mm(parameters.step.width) / 2;
  const fixed::Length middle = robot.com.sole == hal::Side::kLeft ? -half_width : half_width;
  const fixed::Length aside = robot.com.dcm.y - middle;
  if (fixed::abs(ahead) <= most || !moves_on || fixed::abs(aside) > fixed::abs(ahead) * 2)
    return std::nullopt;
  return aside >= fixed::Length() ? hal::Side::kLeft : hal::Side::kRight;
}

void CommandedWalk::advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
                            std::span<fixed::Angle> targets) {
  KOBOSHI_ASSERT(elapsed_us == hal::kControlPeriod_us);
  const estimation::RobotState& robot = inputs.robot;
  // Contacts from the torques of the legs come too late for a touchdown.
  const bool senses_contact = model_.ankle_kind != hal::AnkleKind::kNone;
  const auto load = [&](std::size_t foot) { return senses_contact ? robot.feet[foot].load : fixed::Force(); };
  walker_.advance(velocity_, {.roll = robot.roll,
                              .pitch = robot.pitch,
                              .turn = robot.turn,
                              .loads = {load(0), load(1)},
                              .dcm = measured_dcm(robot.com),
                              .angles = inputs.angles});
  std::ranges::copy(walker_.targets(), targets.begin());
}

}  // namespace koboshi::behaviour
