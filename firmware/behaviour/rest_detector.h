#pragma once

#include <cstdint>

#include "firmware/fixed/debounce.h"
#include "firmware/robot/geometry.h"

namespace koboshi::behaviour {

// Detects that the trunk is at rest: its rate about each axis stays below kStillRate for kCycles cycles.
class RestDetector {
 public:
  using Rates = robot::Vector<fixed::AngularRate>;

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
