#pragma once

#include "bus/dictionary/network.h"
#include "view/recording/recording.h"

namespace koboshi::view {

struct WalkingRecordingOptions {
  double duration_s = 4.0;
  int signals = 0;              // additional signals of measured noise
  int drives = 2;               // each sends a PDO per tick
  double stumbles_at_s = -1.0;  // from here on the trunk leans differently; negative: never
};

// A recording of a robot that never existed: a trunk, a round head and two legs that walk along x. It
// contains everything that a recording can, in forms that are easy to compute again: the trunk is at x = 0.1
// m/s * t. Times start at 10 ms, as those of a run.
Recording walking_recording(const WalkingRecordingOptions& options = {});

// The messages on the bus of that recording.
const bus::Network& walking_network();

}  // namespace koboshi::view
