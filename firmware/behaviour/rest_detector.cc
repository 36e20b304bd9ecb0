#include "firmware/behaviour/rest_detector.h"

#include "firmware/behaviour/posture.h"

namespace koboshi::behaviour {

bool RestDetector::update(const Rates& rates) {
  const bool slow = fixed::abs(rates.x) < kStillRate && fixed::abs(rates.y) < kStillRate &&
                    fixed::abs(rates.z) < kStillRate;
  return slow_.update(slow, kCycles);
}

}  // namespace koboshi::behaviour
