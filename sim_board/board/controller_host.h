#pragma once

#include "hal/lockstep/batch.h"

namespace koboshi::sim {

// Where the firmware runs: in this process, or in a machine of its own. One exchange is one `service` call of
// the firmware and, if the input says so, the `tick` that follows it.
class ControllerHost {
 public:
  virtual ~ControllerHost() = default;

  // `output` is overwritten. Throws std::runtime_error when the firmware cannot be reached any more.
  virtual void exchange(const hal::BatchInput& input, hal::BatchOutput& output) = 0;
};

}  // namespace koboshi::sim
