#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>

#include "hal/cortex_m/fault.h"
#include "hal/cortex_m/mps2/wire.h"
#include "sim_board/board/controller_host.h"
#include "simulation/host/host_factory.h"
#include "simulation/host/qemu_process.h"

namespace koboshi::simulation {

// A fault of the Cortex-M4: its handler pulled the drive-enable line low and reset the core.
class FirmwareFault : public std::runtime_error {
 public:
  explicit FirmwareFault(const cortex_m::FaultRecord& record);
  const cortex_m::FaultRecord& record() const { return record_; }

 private:
  cortex_m::FaultRecord record_;
};

// Runs the firmware as a Cortex-M4 image in QEMU (hal/cortex_m/mps2).
class QemuHost final : public sim_board::ControllerHost {
 public:
  // `more` are additional arguments for QEMU. Throws what QemuProcess throws, and std::length_error if the
  // contents do not fit into the storage.
  QemuHost(const std::filesystem::path& image, std::span<const std::byte> storage_contents,
           std::span<const std::string> more = {});

  // Throws FirmwareFault, and what QemuProcess::ask throws. After a fault the core waits for `start`.
  void exchange(const hal::BatchInput& input, hal::BatchOutput& output) override;
  void archive(sim_board::StateArchive&) override {
    throw sim_board::NotSaveable("firmware inside QEMU has no snapshots: use --controller in-process");
  }
  // Starts the firmware with the present storage, as the constructor does.
  void start() { ask(cortex_m::wire::Kind::kStart, 0); }

  // Instructions that the firmware executed in the last exchange; exact and repeatable.
  std::uint32_t last_instructions() const;
  // Maximum stack depth since the start.
  std::uint32_t stack_peak_bytes();
  // Provokes a fault. Always throws FirmwareFault.
  void provoke(cortex_m::wire::Provocation provocation);

  pid_t pid() const { return process_.pid(); }

 private:
  std::span<std::byte> request_body() { return std::span(request_).subspan(cortex_m::wire::kHeaderBytes); }
  void program(std::span<const std::byte> contents);
  // Sends a request and returns the body of the answer, valid until the next request.
  std::span<const std::byte> ask(cortex_m::wire::Kind kind, std::size_t body_size);

  QemuProcess process_;
  std::array<std::byte, cortex_m::wire::kMaxMessageBytes> request_{};
  std::array<std::byte, cortex_m::wire::kMaxMessageBytes> answer_{};
  std::uint32_t last_periods_ = 0;  // of SysTick
};

// Returns a factory of hosts that run this image in QEMU.
[[nodiscard]] HostFactory in_qemu(const std::filesystem::path& image);

// Returns the default path of the image: next to this program's preset, or in the build folder of the current
// folder (where ./run target builds it).
[[nodiscard]] std::filesystem::path default_image();

}  // namespace koboshi::simulation
