#pragma once

#include "firmware/fixed/units.h"

namespace koboshi::balance {

// What the trunk does beyond what is planned. A lean ahead has positive pitch, one to the right positive
// roll.
struct TrunkMotion {
  fixed::AngularRate roll_rate;  // in axes of B, free of bias
  fixed::AngularRate pitch_rate;
  fixed::Angle roll;
  fixed::Angle pitch;
};

}  // namespace koboshi::balance
