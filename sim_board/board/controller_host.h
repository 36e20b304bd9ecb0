#pragma once

#include "hal/lockstep/batch.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim_board {

// Runs the firmware in this process or in a virtual machine. One exchange is one `service` call of the
// firmware and, if the input requests it, the following `tick`.
class ControllerHost {
 public:
  virtual ~ControllerHost() = default;

  // Overwrites `output`. Throws std::runtime_error if the firmware can no longer be reached.
  virtual void exchange(const hal::BatchInput& input, hal::BatchOutput& output) = 0;

  // Saves or restores the firmware and its storage between two exchanges. Throws NotSaveable if it runs
  // outside this process.
  virtual void archive(StateArchive& archive) = 0;
};

}  // namespace koboshi::sim_board
