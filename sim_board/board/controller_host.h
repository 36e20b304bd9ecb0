#pragma once

#include "hal/lockstep/batch.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim {

// Where the firmware runs: in this process, or in a machine of its own. One exchange is one `service` call of
// the firmware and, if the input says so, the `tick` that follows it.
class ControllerHost {
 public:
  virtual ~ControllerHost() = default;

  // `output` is overwritten. Throws std::runtime_error when the firmware cannot be reached any more.
  virtual void exchange(const hal::BatchInput& input, hal::BatchOutput& output) = 0;

  // Saves or restores the firmware and its storage between two exchanges. Throws NotSaveable where it runs
  // outside of this process.
  virtual void archive(StateArchive& archive) = 0;
};

}  // namespace koboshi::sim
