#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "firmware/app/controller.h"
#include "hal/flash/flash_model.h"
#include "hal/lockstep/batch_board.h"
#include "sim_board/board/controller_host.h"
#include "simulation/host/flash_memory.h"

namespace koboshi::simulation {

// Runs the firmware in this process.
class InProcessHost final : public sim_board::ControllerHost {
 public:
  // Storage as in FlashMemory; sensors as in hal::Board.
  explicit InProcessHost(std::span<const std::byte> storage_contents,
                         const std::filesystem::path& storage_file = {},
                         std::span<const std::uint8_t> sensor_nodes = {})
      : flash_(storage_contents, storage_file), board_(storage_, sensor_nodes) {}

  void exchange(const hal::BatchInput& input, hal::BatchOutput& output) override;
  void archive(sim_board::StateArchive& archive) override;
  const app::ControllerValues& values() const { return controller_.values(); }
  const robot::RobotModel& model() const { return controller_.model(); }
  const policy::Residual& residual() const { return controller_.residual(); }
  policy::Residual& residual() { return controller_.residual(); }

 private:
  FlashMemory flash_;
  hal::FlashModel storage_{flash_.bytes()};
  hal::BatchBoard board_;
  app::Controller controller_{board_.board()};
};

}  // namespace koboshi::simulation
