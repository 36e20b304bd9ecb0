#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/units.h"
#include "firmware/walk/plane.h"
#include "hal/port/period.h"

namespace koboshi::walk {

// Period of the control cycle at 100 Hz, in seconds.
inline constexpr fixed::Ratio kTick_s =
    fixed::mul_div(fixed::kOne, static_cast<std::int32_t>(hal::kControlPeriod_us), 1'000'000);

// Motion of the centre of mass (CoM) over level ground, split in two (Englsberger, Ott and Albu-Schaeffer,
// "Three-dimensional bipedal walking control based on divergent component of motion", T-RO 2015). With
// omega = sqrt(g / z)
//
//   dcm = x + x' / omega    the divergent component of motion, which runs away from the ZMP
//   ccm = x - x' / omega    the convergent component, which runs into it
//
// and x = (dcm + ccm) / 2.
struct PendulumState {
  Point dcm;
  Point ccm;

  [[nodiscard]] static PendulumState at_rest(Point p) { return {p, p}; }
  [[nodiscard]] Point position() const {
    const Point sum = dcm + ccm;
    return {sum.x / 2, sum.y / 2};
  }
};

// The linear inverted pendulum x'' = (x - p) / T_c^2 with T_c = sqrt(z / g), sagittal and lateral alike
// (Kajita et al., "The 3D linear inverted pendulum mode", IROS 2001). About a ZMP p that rests over a cycle
// of h = 10 ms its motion is, exactly but for rounding,
//
//   dcm(t + h) = p + e^( omega h) (dcm(t) - p)
//   ccm(t + h) = p + e^(-omega h) (ccm(t) - p)
class Pendulum {
 public:
  static constexpr std::size_t kMaxTicks = 60;

  // `height` of the CoM, clamped to 0.05 to 1 m.
  explicit Pendulum(fixed::Length height);

  // Advances the state by one cycle.
  void advance(PendulumState& state, Point zmp) const;
  // Growth G = e^(omega t) of the DCM's distance from the ZMP over `ticks` cycles, at most kMaxTicks.
  [[nodiscard]] fixed::Gain growth(std::size_t ticks) const {
    KOBOSHI_ASSERT(ticks <= kMaxTicks);
    return growth_[ticks];
  }
  // Effect on the DCM of a ZMP that ramps to its place over `ticks` cycles: that of a ZMP that steps there at
  // once, with the DCM further back by this share of the ZMP's distance. Derivation in pendulum.cc.
  [[nodiscard]] fixed::Ratio lag(std::int32_t ticks) const;
  // T_c = sqrt(z / g), in seconds.
  [[nodiscard]] fixed::Ratio time_constant_s() const { return time_constant_s_; }

 private:
  fixed::Ratio time_constant_s_;
  fixed::Ratio growth_of_a_tick_;  // e^(omega h)
  fixed::Ratio decay_of_a_tick_;   // e^(-omega h)
  std::array<fixed::Gain, kMaxTicks + 1> growth_{};
};

}  // namespace koboshi::walk
