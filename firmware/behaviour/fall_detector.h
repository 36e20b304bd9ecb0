#pragma once

#include <cstdint>

#include "firmware/estimation/trunk_motion.h"

namespace koboshi::behaviour {

// The lean that counts as a fall. Angles in units of 2^-16 turn. A limit of 0 is not set; while any of the
// four is not, falls are not detected.
struct FallLimits {
  std::int16_t front = 0;  // of the predicted lean, as the next two
  std::int16_t back = 0;
  std::int16_t side = 0;
  std::int16_t lead_ms = 0;   // how far ahead a lean is predicted: the pendulum's time constant
  std::int16_t min_lean = 0;  // of the present lean: with less, no rate makes a fall
  std::int16_t cycles = 1;    // of 10 ms, in a row

  [[nodiscard]] bool are_set() const { return front > 0 && back > 0 && side > 0 && min_lean > 0; }
};

enum class FallDirection : std::uint8_t { kNone, kFront, kBack, kLeft, kRight };

// Foresees a fall from angle and rate together: by a linear inverted pendulum's capture point, x + v / omega
// (Pratt et al. 2006), in angles. The lean as it will be in `lead_ms`, if its rate lasts, is held against an
// ellipse that is as far as the feet are long and wide.
class FallDetector {
 public:
  // The next 10 ms cycle of a robot that stands on its feet. Where it falls to, once it does.
  FallDirection update(const FallLimits& limits, const estimation::TrunkMotion& trunk);
  // The robot is put down or carried: nothing is a fall before it was upright again.
  void disarm();
  // It has to be on its feet now: should it lie, it has fallen.
  void arm() { armed_ = true; }

 private:
  bool armed_ = false;
  std::int16_t cycles_ = 0;  // beyond the limits, in a row
};

}  // namespace koboshi::behaviour
