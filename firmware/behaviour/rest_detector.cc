#include "firmware/behaviour/rest_detector.h"

namespace koboshi::behaviour {

bool RestDetector::update(const Rates& rates) {
  const bool slow =
      fixed::abs(rates.x) < kMaxRate && fixed::abs(rates.y) < kMaxRate && fixed::abs(rates.z) < kMaxRate;
  return slow_.update(slow, kCycles);
}

}  // namespace koboshi::behaviour
