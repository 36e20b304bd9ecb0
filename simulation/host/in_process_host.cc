#include "simulation/host/in_process_host.h"

namespace koboshi::simulation {

void InProcessHost::exchange(const hal::BatchInput& input, hal::BatchOutput& output) {
  board_.begin(input);
  controller_.service(input.now_us);
  if (input.tick) controller_.tick(input.now_us);
  output = board_.end();
}

}  // namespace koboshi::simulation
