#pragma once

#include "firmware/fixed/quantity.h"

namespace koboshi::fixed {

// The quantities of the firmware, each with its unit, Q-format and overflow. The formats appear here only.
// Durations and instants are raw microseconds (`_us`), as the HAL has them.

// Binary turns in [-1/2, 1/2): 2^32 LSB = one turn = 2 pi rad; LSB 1.5e-9 rad. Sums wrap as a shaft does. The
// counts of a 12-bit encoder become angles by a shift of 20. Clamp a joint's angle to its limits before
// adding to it.
using Angle = Quantity<struct AngleTag, 32, Overflow::kWrap>;
// turn/s, to +-128 turn/s (46080 deg/s); LSB 3.7e-7 rad/s, a tenth of a microdegree over one 10 ms tick.
using AngularRate = Quantity<struct AngularRateTag, 24, Overflow::kSaturate>;
// m, to +-128 m; LSB 60 nm.
using Length = Quantity<struct LengthTag, 24, Overflow::kSaturate>;
// m/s, to +-128 m/s; LSB 60 nm/s.
using Speed = Quantity<struct SpeedTag, 24, Overflow::kSaturate>;
// N m, to +-2048 N m; LSB 0.95 uN m.
using Torque = Quantity<struct TorqueTag, 20, Overflow::kSaturate>;
// N, to +-32768 N; LSB 15 uN.
using Force = Quantity<struct ForceTag, 16, Overflow::kSaturate>;
// m/s^2, to +-2048 m/s^2 (209 g); LSB 0.95 um/s^2.
using Acceleration = Quantity<struct AccelerationTag, 20, Overflow::kSaturate>;
// kg, to 128 kg; LSB 60 ug.
using Mass = Quantity<struct MassTag, 24, Overflow::kSaturate>;
// A dimensionless factor to +-32768; LSB 1.5e-5.
using Gain = Quantity<struct GainTag, 16, Overflow::kSaturate>;
// A dimensionless number in [-2, 2): sines, cosines, fractions; LSB 9.3e-10.
using Ratio = Quantity<struct RatioTag, 30, Overflow::kSaturate>;

inline constexpr Angle kQuarterTurn = Angle::from_raw(1 << 30);
inline constexpr Ratio kOne = Ratio::from_raw(1 << 30);

}  // namespace koboshi::fixed
