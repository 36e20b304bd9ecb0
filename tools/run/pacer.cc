#include "tools/run/pacer.h"

#include <algorithm>

namespace koboshi::tools {

void Pacer::wait_for(std::uint64_t now_us) {
  const WallClock::Time due =
      start_ +
      std::chrono::microseconds(static_cast<std::int64_t>(static_cast<double>(now_us - start_us_) / speed_));
  const WallClock::Time now = wall_.now();
  delay_us_ = 0;
  if (now < due) {
    wall_.sleep_until(due);
    return;
  }
  delay_us_ =
      static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(now - due).count());
  largest_delay_us_ = std::max(largest_delay_us_, delay_us_);
  if (delay_us_ > kTolerance_us) ++overruns_;
}

}  // namespace koboshi::tools
