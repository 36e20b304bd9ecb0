#include "firmware/estimation/gyro_bias.h"

#include <algorithm>

#include "firmware/fixed/rounding.h"

namespace koboshi::estimation {

bool GyroBias::observe(const Rates& rates) {
  const std::array<fixed::AngularRate, 3> sample{rates.x, rates.y, rates.z};
  if (count_ == 0) restart(sample);
  for (std::size_t i = 0; i < sample.size(); ++i) {
    Axis& axis = axes_[i];
    axis.lowest = std::min(axis.lowest, sample[i]);
    axis.highest = std::max(axis.highest, sample[i]);
    if (axis.highest - axis.lowest > kMaxSpread) return restart(sample), false;
    axis.sum_raw += sample[i].raw();
  }
  if (++count_ < kSamples) return false;
  bias_ = {mean(0), mean(1), mean(2)};
  count_ = 0;
  return true;
}

void GyroBias::restart(const std::array<fixed::AngularRate, 3>& rates) {
  count_ = 0;
  for (std::size_t i = 0; i < rates.size(); ++i) axes_[i] = {0, rates[i], rates[i]};
}

fixed::AngularRate GyroBias::mean(std::size_t axis) const {
  return fixed::AngularRate::from_wide_raw(fixed::divide_rounded(axes_[axis].sum_raw, kSamples));
}

}  // namespace koboshi::estimation
