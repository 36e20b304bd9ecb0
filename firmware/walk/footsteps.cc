#include "firmware/walk/footsteps.h"

#include "firmware/fixed/literals.h"

namespace koboshi::walk {

using fixed::Angle;
using fixed::Gain;
using fixed::Length;
using hal::Side;
using namespace fixed::literals;

Footsteps::Footsteps(Length width, Gain growth, fixed::Ratio lag)
    : width_(width),
      growth_(growth),
      lag_(lag),
      share_(fixed::quotient<fixed::Ratio>(1.0_gain, fixed::product<Gain>(growth, growth) - 1.0_gain)),
      widening_(fixed::quotient<Gain>(fixed::kOne, fixed::kOne - lag)) {}

Foothold Footsteps::step(Side swing, const Stride& stride) const {
  const bool left = swing == Side::kLeft;
  const bool opens = left == (stride.distance.y > Length());
  const Length lateral = opens ? stride.distance.y * 2 : Length();
  return {.p = {stride.distance.x, (left ? width_ : -width_) + lateral}, .yaw = stride.turn};
}

// Let b be the offset of the DCM from the new ZMP when a step begins, s_0 the last step and c = b + lag s_0
// the offset as for a ZMP that steps at once (Pendulum::lag). From one step to the next, with the growth G,
//
//   G c = (1 - lag) s + c_next
//
// In a gait that repeats itself after the steps s_1 and s_2 therefore c = (1 - lag) (G s_1 + s_2) / (G^2 -
// 1). Without double support lag is 0.
Point Footsteps::offset_at_once(Side stance, const Stride& stride) const {
  const Point first = step(other(stance), stride).p;
  const Point second = step(stance, stride).p;
  const auto along = [&](Length a, Length b) {
    return fixed::product<Length>(fixed::product<Length>(a, growth_) + b, share_);
  };
  return {along(first.x, second.x), along(first.y, second.y)};
}

Point Footsteps::offset(Side stance, const Stride& stride) const {
  const Point at_once = offset_at_once(stance, stride);
  const Point last = step(stance, stride).p;
  const auto along = [&](Length c, Length b) {
    return fixed::product<Length>(c, fixed::kOne - lag_) - fixed::product<Length>(b, lag_);
  };
  return {along(at_once.x, last.x), along(at_once.y, last.y)};
}

}  // namespace koboshi::walk
