#include "tools/run/in_process_host.h"

#include <stdexcept>

namespace koboshi::tools {

InProcessHost::InProcessHost(std::span<const std::byte> storage_contents) {
  if (storage_contents.size() > kSectors * kSectorSize_bytes) {
    throw std::length_error("model and motions take " + std::to_string(storage_contents.size()) +
                            " bytes, more than the storage's " +
                            std::to_string(kSectors * kSectorSize_bytes));
  }
  storage_.load(0, storage_contents);
  controller_ = std::make_unique<app::Controller>(board_.board());
}

void InProcessHost::exchange(const hal::BatchInput& input, hal::BatchOutput& output) {
  board_.begin(input);
  controller_->service(input.now_us);
  if (input.tick) controller_->tick(input.now_us);
  output = board_.end();
}

}  // namespace koboshi::tools
