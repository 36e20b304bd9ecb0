#pragma once

#include <span>

#include "firmware/app/controller.h"
#include "hal/fake/storage.h"
#include "hal/lockstep/batch_board.h"
#include "sim_board/board/controller_host.h"

namespace koboshi::test {

inline constexpr std::uint8_t kController = 1;  // node id of the controller

// Runs the firmware in this process and exposes its state, also while the bus is down.
class OpenHost final : public sim_board::ControllerHost {
 public:
  explicit OpenHost(std::span<const std::byte> storage_contents) : storage_(filled(storage_contents)) {}

  void exchange(const hal::BatchInput& input, hal::BatchOutput& output) override {
    board_.begin(input);
    controller_.service(input.now_us);
    if (input.tick) controller_.tick(input.now_us);
    output = board_.end();
  }
  void archive(sim_board::StateArchive& archive) override {
    archive(storage_);
    archive.in_place(board_, controller_);
  }
  const app::Controller& controller() const { return controller_; }

 private:
  static constexpr std::size_t kSectorSize_bytes = 2048;
  static constexpr std::size_t kSectors = 128;

  static hal::FakeStorage filled(std::span<const std::byte> contents) {
    hal::FakeStorage storage(kSectors, kSectorSize_bytes);
    storage.load(0, contents);
    return storage;
  }

  hal::FakeStorage storage_;
  hal::BatchBoard board_{storage_};
  app::Controller controller_{board_.board()};
};

}  // namespace koboshi::test
