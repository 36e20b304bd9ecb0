#pragma once

#include <cstdint>

#include "firmware/fixed/debounce.h"
#include "firmware/fixed/literals.h"
#include "firmware/robot/geometry.h"

namespace koboshi::behaviour {

// Whether the trunk has come to rest: a while in which it turned slowly about every axis.
class RestDetector {
 public:
  using Rates = robot::Vector<fixed::AngularRate>;

  // As slowly as a robot that counts as standing (Stelter and Bestmann 2021).
  static constexpr auto kMaxRate = fixed::literals::operator""_rad_per_s(0.15L);
  static constexpr std::uint16_t kCycles = 15;  // of 10 ms; a trunk that rocks turns round in less

  // The next cycle's rates, free of the gyro's bias. True from the end of the while on.
  bool update(const Rates& rates);
  void restart() { slow_.reset(); }

 private:
  fixed::Debounce slow_;
};

}  // namespace koboshi::behaviour
