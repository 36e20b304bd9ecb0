#pragma once

#include <cstdint>
#include <optional>

#include "firmware/estimation/trunk_motion.h"
#include "firmware/fixed/debounce.h"

namespace koboshi::behaviour {

// The lean that counts as a fall. Angles in units of 2^-16 turn. An angle of 0 means "not set"; unless all
// four angles are set, falls are not detected.
struct FallLimits {
  std::int16_t front = 0;  // of the predicted lean, as the next two
  std::int16_t back = 0;
  std::int16_t side = 0;
  std::int16_t lead_ms = 0;   // how far ahead a lean is predicted: the pendulum's time constant
  std::int16_t min_lean = 0;  // of the present lean; below it, no rate counts as a fall
  std::int16_t cycles = 1;    // of 10 ms, in a row
  // While a walk measures its DCM error: the share of the angles above that counts, and the error that no
  // step catches. 0: the lean alone decides, as while the robot stands.
  std::int16_t walking_percent = 100;
  std::int16_t uncatchable_percent = 0;

  [[nodiscard]] bool are_set() const { return front > 0 && back > 0 && side > 0 && min_lean > 0; }
};

enum class FallDirection : std::uint8_t { kNone, kFront, kBack, kLeft, kRight };

// Detects a fall before the robot hits the ground, from the lean of the trunk and its rate:
//
//   predicted = lean + lead * rate
//
// which is the capture point x + v / omega of the linear inverted pendulum (Pratt et al., "Capture point: a
// step toward humanoid push recovery", Humanoids 2006) in angles, with lead = 1 / omega. The robot falls when
// the predicted lean leaves the ellipse (forward / front or back)^2 + (lateral / side)^2 = 1 for `cycles`
// cycles in a row while the present lean is at least `min_lean`.
//
// A robot that walks may lean further, because a step catches it. There the limits are `walking_percent` of
// these, and a DCM error beyond `uncatchable_percent` of what the next steps reach is a fall as well, at the
// same least lean (walk::Walker::error_percent).
class FallDetector {
 public:
  // Takes the next cycle of 10 ms of a robot on its feet. Returns the direction of a fall in the cycle in
  // which it is detected, kNone in every other. O(1).
  // `error_percent`: of a walk that measures it.
  FallDirection update(const FallLimits& limits, const estimation::TrunkMotion& trunk,
                       std::optional<std::uint16_t> error_percent = std::nullopt);
  // Stops the detection until the trunk has been within `min_lean` once: a robot that is carried or put down
  // does not fall.
  void disarm();
  // Starts the detection at once: the robot is on its feet, and if it leans it falls.
  void arm() { armed_ = true; }

 private:
  bool armed_ = false;
  fixed::Debounce beyond_;  // the ellipse
};

}  // namespace koboshi::behaviour
