#include "firmware/estimation/ground.h"

#include "firmware/fixed/interpolation.h"
#include "firmware/fixed/literals.h"

namespace koboshi::estimation {

using fixed::Length;
using fixed::Ratio;
using namespace fixed::literals;

namespace {

// 1.65^2 / (1.65^2 + 1.0^2): the share of the pressure's measurement.
constexpr Ratio kPressureShare = 0.73_ratio;
constexpr Ratio kGroundShare = 0.0328_ratio;  // of a cycle: 1 - e^(-10 ms / 0.3 s)
constexpr Ratio kLeastUp = 0.5_ratio;         // a sole that is tilted by more than 60 degrees stands on edge
constexpr Length kLeastHeight = 0.02_m;

}  // namespace

const Ground& GroundEstimator::update(const Posture& posture, const robot::Direction& up_B,
                                      const Pressure& zmp) {
  if (!zmp.valid) return ground_;
  const robot::Direction up = robot::transpose(posture.X_BSole[zmp.frame].R) * up_B;
  const robot::Position com = posture.centre_of_mass(zmp.frame);
  if (up.z < kLeastUp || com.z < kLeastHeight) return ground_;
  const auto estimate = [&](Length r, Length c, Ratio along, Ratio& slope, Ratio& zero) {
    const Ratio by_pressure = fixed::quotient<Ratio>(r - c, com.z);
    const Ratio by_attitude = fixed::quotient<Ratio>(along, up.z);
    const Ratio now = by_attitude + fixed::product<Ratio>(by_pressure - by_attitude, kPressureShare);
    const Ratio share = ground_.valid ? kGroundShare : fixed::kOne;
    slope = fixed::interpolate(slope, now, share);
    zero = fixed::interpolate(zero, by_attitude - now, share);
  };
  estimate(com.x, zmp.x, up.x, ground_.slope_x, ground_.zero_x);
  estimate(com.y, zmp.y, up.y, ground_.slope_y, ground_.zero_y);
  ground_.valid = true;
  return ground_;
}

}  // namespace koboshi::estimation
