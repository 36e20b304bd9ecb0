#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/literals.h"
#include "firmware/fixed/units.h"
#include "firmware/walk/plane.h"

namespace koboshi::walk {

// The 100 Hz control cycle, in seconds.
inline constexpr fixed::Ratio kTick_s = fixed::literals::operator""_ratio(0.01L);

// The centre of mass over level ground, its motion split in two (Englsberger, Ott and Albu-Schaeffer, 2015):
// with omega = sqrt(g / z), xi = x + v / omega runs away from the ZMP and x - v / omega runs into it.
struct PendulumState {
  Point dcm;
  Point ccm;

  [[nodiscard]] static PendulumState at_rest(Point p) { return {p, p}; }
  [[nodiscard]] Point position() const {
    const Point sum = dcm + ccm;
    return {sum.x / 2, sum.y / 2};
  }
};

// The paper's linear inverted pendulum, x'' = (x - p) / T_c^2 with T_c = sqrt(z / g), sagittal and lateral
// alike, in steps of the 100 Hz cycle: about a ZMP that rests over the cycle, exact but for rounding.
class Pendulum {
 public:
  static constexpr std::size_t kMaxTicks = 60;

  // `height` of the centre of mass, 0.05 to 1 m.
  explicit Pendulum(fixed::Length height);

  void advance(PendulumState& state, Point zmp) const;
  // By how much the divergent part's distance from the ZMP grows in `ticks`, at most kMaxTicks: e^(omega t).
  [[nodiscard]] fixed::Gain growth(std::size_t ticks) const {
    KOBOSHI_ASSERT(ticks <= kMaxTicks);
    return growth_[ticks];
  }
  // A ZMP that takes `ticks` cycles to come from the last foot moves the divergent part as one that came at
  // once from a state this share of its way behind would.
  [[nodiscard]] fixed::Ratio lag(std::int32_t ticks) const;
  // The paper's T_c, in seconds.
  [[nodiscard]] fixed::Ratio time_constant_s() const { return time_constant_s_; }

 private:
  fixed::Ratio time_constant_s_;
  fixed::Ratio growth_of_a_tick_;  // e^(omega h)
  fixed::Ratio decay_of_a_tick_;   // e^(-omega h)
  std::array<fixed::Gain, kMaxTicks + 1> growth_{};
};

}  // namespace koboshi::walk
