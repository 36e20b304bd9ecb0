#pragma once

#include <cstdint>

#include "firmware/fixed/debounce.h"
#include "firmware/fixed/literals.h"
#include "firmware/robot/geometry.h"

namespace koboshi::behaviour {

// Detects that the trunk is at rest: its rate about each axis stays below kMaxRate for kCycles cycles.
class RestDetector {
 public:
  using Rates = robot::Vector<fixed::AngularRate>;

  // The rate below which Stelter and Bestmann (2021) count a robot as standing after a stand-up motion.
  static constexpr auto kMaxRate = fixed::literals::operator""_rad_per_s(0.15L);
  // A rocking trunk is slow while it reverses, for less than this. Set by hand (2026-11-22).
  static constexpr std::uint16_t kCycles = 15;  // 150 ms at 100 Hz

  // One 100 Hz cycle. `rates`: of the trunk in axes of B, free of the gyro's bias. Returns true from the
  // kCycles-th consecutive slow cycle on.
  bool update(const Rates& rates);
  // Forgets the cycles so far.
  void restart() { slow_.reset(); }

 private:
  fixed::Debounce slow_;
};

}  // namespace koboshi::behaviour
