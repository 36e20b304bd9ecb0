#include "firmware/walk/pendulum.h"

#include <algorithm>

#include "firmware/fixed/gravity.h"
#include "firmware/fixed/literals.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::walk {

using fixed::Gain;
using fixed::Length;
using fixed::Ratio;
using namespace fixed::literals;

namespace {

constexpr Length kLowest = 0.05_m;
constexpr Length kHighest = 1.0_m;

// e^x by its series, for |x| <= 0.15: the first term left out is below 2^-30.
Ratio exponential(Ratio x) {
  Ratio sum = fixed::kOne;
  for (int term = 6; term > 0; --term) sum = fixed::kOne + fixed::product<Ratio>(x, sum) / term;
  return sum;
}

Length toward(Length from, Length value, Ratio factor) {
  return from + fixed::product<Length>(value - from, factor);
}

}  // namespace

Pendulum::Pendulum(Length height) {
  const Length bounded = std::clamp(height, kLowest, kHighest);
  time_constant_s_ = fixed::square_root<Ratio>(fixed::product<Ratio>(bounded, fixed::kInverseGravity));
  const Ratio x = fixed::quotient<Ratio>(kTick_s, time_constant_s_);
  growth_of_a_tick_ = exponential(x);
  decay_of_a_tick_ = exponential(-x);
  growth_[0] = 1.0_gain;
  for (std::size_t tick = 1; tick <= kMaxTicks; ++tick) {
    growth_[tick] = fixed::product<Gain>(growth_[tick - 1], growth_of_a_tick_);
  }
}

// In cycle k of the ramp the ZMP has come the share k / (n + 1) of its distance s, so (1 - k / (n + 1)) s is
// missing. A ZMP that is off by d for one cycle moves the DCM by (e^(omega h) - 1) d, which every later cycle
// multiplies by e^(omega h); as seen from the beginning of the ramp, by e^(-omega h k). The sum over all
// cycles, divided by s:
//
//   lambda = sum over k = 1..n of (1 - k / (n + 1)) (e^(omega h) - 1) e^(-omega h k)
Ratio Pendulum::lag(std::int32_t ticks) const {
  Ratio sum;
  Ratio seen = growth_of_a_tick_ - fixed::kOne;
  for (std::int32_t tick = 1; tick <= ticks; ++tick) {
    seen = fixed::product<Ratio>(seen, decay_of_a_tick_);
    sum += fixed::mul_div(seen, ticks + 1 - tick, ticks + 1);
  }
  return sum;
}

void Pendulum::advance(PendulumState& state, Point zmp) const {
  const auto advanced = [&](Point p, Ratio factor) {
    return Point{toward(zmp.x, p.x, factor), toward(zmp.y, p.y, factor)};
  };
  state.dcm = advanced(state.dcm, growth_of_a_tick_);
  state.ccm = advanced(state.ccm, decay_of_a_tick_);
}

}  // namespace koboshi::walk
