#include "firmware/walk/footsteps.h"

#include "firmware/fixed/literals.h"

namespace koboshi::walk {

using fixed::Angle;
using fixed::Gain;
using fixed::Length;
using hal::Side;
using namespace fixed::literals;

Foothold Footsteps::step(Side swing, const Stride& stride) const {
  const bool left = swing == Side::kLeft;
  const bool opens = left == (stride.way.y > Length());
  const bool turns_out = left == (stride.turn > Angle());
  const Length aside = opens ? stride.way.y * 2 : Length();
  return {.p = {stride.way.x, (left ? width_ : -width_) + aside},
          .yaw = turns_out ? stride.turn * 2 : Angle()};
}

// From one step to the next the offset b obeys b_next = growth b - step; a motion of two steps that repeats
// itself has b = (growth step_1 + step_2) / (growth^2 - 1).
Point Footsteps::offset(Side stance, const Stride& stride) const {
  const Point first = step(other(stance), stride).p;
  const Point second = step(stance, stride).p;
  const Gain divisor = fixed::product<Gain>(growth_, growth_) - 1.0_gain;
  const auto along = [&](Length a, Length b) {
    return fixed::quotient<Length>(fixed::product<Length>(a, growth_) + b, divisor);
  };
  return {along(first.x, second.x), along(first.y, second.y)};
}

}  // namespace koboshi::walk
