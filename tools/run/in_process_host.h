#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "firmware/app/controller.h"
#include "hal/fake/storage.h"
#include "hal/port/batch_board.h"
#include "sim_board/board/controller_host.h"

namespace koboshi::tools {

// The firmware in this process.
class InProcessHost final : public sim::ControllerHost {
 public:
  static constexpr std::size_t kSectorSize_bytes = 2048;
  static constexpr std::size_t kSectors = 128;

  // Throws std::length_error when the contents do not fit into storage.
  explicit InProcessHost(std::span<const std::byte> storage_contents);

  void exchange(const hal::BatchInput& input, hal::BatchOutput& output) override;

  const app::Controller& controller() const { return *controller_; }

 private:
  hal::FakeStorage storage_{kSectors, kSectorSize_bytes};
  hal::BatchBoard board_{storage_};
  std::unique_ptr<app::Controller> controller_;  // made once storage has its contents
};

}  // namespace koboshi::tools
