#pragma once

#include <cstdint>

#include "firmware/recovery/fall_watch.h"

namespace koboshi::recovery {

struct GettingUp {
  std::uint8_t attempts = 3;  // of which each is slower than the last; 0: who falls stays down
  std::uint8_t slower = 20;   // percent of the first one's pace, which each further attempt has less
};

struct RecoveryParameters {
  FallLimits fall;
  GettingUp getting_up;
};

}  // namespace koboshi::recovery
