#include "firmware/behaviour/stillness.h"

#include "firmware/fixed/saturating.h"

namespace koboshi::behaviour {

bool Stillness::update(const Rates& rates) {
  const bool slow =
      fixed::abs(rates.x) < kMaxRate && fixed::abs(rates.y) < kMaxRate && fixed::abs(rates.z) < kMaxRate;
  cycles_ = slow ? fixed::add_saturated(cycles_, std::uint8_t{1}) : std::uint8_t{0};
  return cycles_ >= kCycles;
}

}  // namespace koboshi::behaviour
