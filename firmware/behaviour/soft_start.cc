#include "firmware/behaviour/soft_start.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/interpolation.h"

namespace koboshi::behaviour {

void SoftStart::begin(std::span<const fixed::Angle> from, std::span<const fixed::Angle> to,
                      std::int16_t rate) {
  KOBOSHI_ASSERT(from.size() == to.size() && from.size() <= from_.size() && rate > 0);
  joints_ = from.size();
  std::int64_t longest_raw = 0;
  for (std::size_t joint = 0; joint < joints_; ++joint) {
    from_[joint] = from[joint];
    to_[joint] = to[joint];
    const std::int64_t travel_raw = std::int64_t{to[joint].raw()} - from[joint].raw();
    longest_raw = std::max(longest_raw, travel_raw < 0 ? -travel_raw : travel_raw);
  }
  // The angle has 32 fraction bits, the rate 12: the travel takes raw / (rate * 2^20) seconds.
  const std::int64_t rate_raw = std::int64_t{rate} << 20;
  const std::int64_t time_us = (longest_raw * 1'000'000 + rate_raw - 1) / rate_raw;
  duration_us_ = std::max(kMinDuration_us, static_cast<std::int32_t>(time_us));
  elapsed_us_ = 0;
}

void SoftStart::advance(std::uint32_t elapsed_us, const motion::Inputs& /*inputs*/,
                        std::span<fixed::Angle> targets) {
  elapsed_us_ += static_cast<std::int32_t>(elapsed_us);
  const fixed::Ratio fraction = fixed::elapsed_fraction(elapsed_us_, duration_us_);
  for (std::size_t joint = 0; joint < joints_; ++joint)
    targets[joint] = fixed::interpolate(from_[joint], to_[joint], fraction);
}

}  // namespace koboshi::behaviour
