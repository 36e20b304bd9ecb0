#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "firmware/app/controller.h"
#include "hal/flash/flash_model.h"
#include "hal/port/batch_board.h"
#include "sim_board/board/controller_host.h"

namespace koboshi::tools {

// The firmware in this process.
class InProcessHost final : public sim::ControllerHost {
 public:
  // Throws std::length_error when the contents do not fit into storage.
  explicit InProcessHost(std::span<const std::byte> storage_contents);

  void exchange(const hal::BatchInput& input, hal::BatchOutput& output) override;

 private:
  std::vector<std::byte> flash_;
  hal::FlashModel storage_{std::span(flash_).first<hal::FlashModel::kSize_bytes>()};
  hal::BatchBoard board_{storage_};
  app::Controller controller_{board_.board()};
};

}  // namespace koboshi::tools
