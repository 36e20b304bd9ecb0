#pragma once

#include <cstdint>

#include "firmware/estimation/zmp.h"

namespace koboshi::estimation {

// Whether a foot bears load, and since when.
struct ContactState {
  bool touches = false;
  // From the last touchdown or lift-off to the end of the cycle, as it was at the foot; saturates. It is
  // known later than it happens, by the age of the sensor's samples.
  std::uint32_t since_us = 0;
};

// Follows the contact of one foot. A load of a twelfth of the robot's weight is a touchdown
// (FootPressure::contact), a load of half of that a lift-off: between them noise changes nothing. The moment
// is where the line through the last two loads crosses the limit.
class ContactWatch {
 public:
  // `min_load`: of a touchdown.
  explicit ContactWatch(fixed::Force min_load) : touchdown_(min_load), liftoff_(min_load / 2) {}

  // Takes a cycle of 10 ms. `age_us`: of the sensor's last sample.
  const ContactState& update(const FootPressure& foot, std::uint32_t age_us);
  const ContactState& state() const { return state_; }

 private:
  fixed::Force touchdown_;
  fixed::Force liftoff_;
  fixed::Force last_load_;
  ContactState state_;
};

}  // namespace koboshi::estimation
