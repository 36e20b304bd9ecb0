#include "tools/run/in_process_host.h"

#include "tools/run/storage_contents.h"

namespace koboshi::tools {

InProcessHost::InProcessHost(std::span<const std::byte> storage_contents)
    : flash_(fill_flash(storage_contents)) {}

void InProcessHost::exchange(const hal::BatchInput& input, hal::BatchOutput& output) {
  board_.begin(input);
  controller_.service(input.now_us);
  if (input.tick) controller_.tick(input.now_us);
  output = board_.end();
}

}  // namespace koboshi::tools
