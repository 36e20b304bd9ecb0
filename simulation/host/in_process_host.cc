#include "simulation/host/in_process_host.h"

#include <memory>

#include "simulation/host/host_factory.h"

namespace koboshi::simulation {

void InProcessHost::exchange(const hal::BatchInput& input, hal::BatchOutput& output) {
  board_.begin(input);
  controller_.service(input.now_us);
  if (input.tick) controller_.tick(input.now_us);
  output = board_.end();
}

HostFactory in_process(const std::filesystem::path& storage_file) {
  return [storage_file](std::span<const std::byte> contents) {
    return std::make_unique<InProcessHost>(contents, storage_file);
  };
}

void InProcessHost::archive(sim_board::StateArchive& archive) {
  archive.flash(flash_.bytes());
  archive(storage_);
  archive.in_place(board_, controller_);
}

}  // namespace koboshi::simulation
