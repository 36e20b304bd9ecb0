#include "firmware/walk/arms.h"

#include <algorithm>
#include <array>

#include "firmware/fixed/literals.h"
#include "firmware/fixed/radians.h"

namespace koboshi::walk {

using fixed::Angle;
using fixed::Gain;
using fixed::Length;
using fixed::product;
using fixed::Ratio;
using namespace fixed::literals;

namespace {

// How far an arm turns in a cycle: against the DCM error 800 degrees/s, more than the servo can follow, and
// back 150 degrees/s, so that what it took comes back over several steps. By hand, 2026-11-30.
constexpr Angle kTurn = 8.0_deg;
constexpr Angle kReturn = 1.5_deg;
// How far it turns. By hand, 2026-11-30: of 100 pushes ahead 9 are lost without the arms, 6, 5 and 4 with 40,
// 60 and 115 degrees; but the further back they are, the later they break the fall of a robot that falls all
// the same (docs/experiment/closed-loop-walk.md).
constexpr Angle kMost = 60.0_deg;

}  // namespace

Arms::Arms(const robot::RobotModel& model) {
  using enum robot::JointRole;
  const std::array roles{kLeftShoulderPitch, kRightShoulderPitch};
  for (std::size_t side = 0; side < roles.size(); ++side) {
    if (const auto joint = model.find(roles[side])) {
      const bool axis_points_left = model.joints[*joint].axis.y > Ratio();
      shoulders_[side] = {*joint, static_cast<std::int8_t>(axis_points_left ? 1 : -1)};
    }
  }
}

void Arms::react(Length dcm_error, Gain reaction) {
  const Angle wanted = std::clamp(fixed::from_rad(product<Ratio>(dcm_error, reaction)), -kMost, kMost);
  const bool returns = fixed::abs(wanted) < fixed::abs(back_);
  const Angle most = returns ? kReturn : kTurn;
  back_ += std::clamp(wanted - back_, -most, most);
}

void Arms::pose(Length left_forward, Ratio swing, std::span<const Angle> standing,
                std::span<Angle> targets) const {
  // An arm that swings forward turns negatively about y; the left arm swings with the right foot.
  const Angle left_back = fixed::from_rad(product<Ratio>(left_forward, swing));
  for (std::size_t side = 0; side < shoulders_.size(); ++side) {
    const Shoulder& shoulder = shoulders_[side];
    if (shoulder.sign == 0) continue;
    const Angle turn = side == 0 ? back_ + left_back : back_ - left_back;
    targets[shoulder.joint] = standing[shoulder.joint] + (shoulder.sign > 0 ? turn : -turn);
  }
}

}  // namespace koboshi::walk
