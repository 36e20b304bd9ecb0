#include "firmware/estimation/contact.h"

#include <algorithm>

#include "firmware/fixed/interpolation.h"
#include "firmware/fixed/saturating.h"
#include "hal/port/period.h"

namespace koboshi::estimation {

const ContactState& ContactWatch::update(const FootPressure& foot, std::uint32_t age_us) {
  const fixed::Force limit = state_.touches ? liftoff_ : touchdown_;
  const bool touches = state_.touches ? foot.load >= limit : foot.load >= limit && foot.contact;
  if (touches != state_.touches) {
    // Between the samples of the last cycle and of this one.
    const std::int64_t way_raw = std::int64_t{foot.load.raw()} - last_load_.raw();
    const std::int64_t left_raw = std::int64_t{foot.load.raw()} - limit.raw();
    const std::int64_t before_us = way_raw == 0 ? 0 : left_raw * hal::kControlPeriod_us / way_raw;
    state_ = {.touches = touches,
              .since_us = fixed::add_saturated(
                  static_cast<std::uint32_t>(std::clamp<std::int64_t>(before_us, 0, hal::kControlPeriod_us)),
                  age_us)};
  } else {
    state_.since_us = fixed::add_saturated(state_.since_us, std::uint32_t{hal::kControlPeriod_us});
  }
  last_load_ = foot.load;
  return state_;
}

}  // namespace koboshi::estimation
