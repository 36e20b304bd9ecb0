#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "hal/linux/can_sensors.h"
#include "sim_board/can/transport/transport.h"
#include "simulation/host/in_process_host.h"

namespace koboshi::simulation {

// The firmware by itself on a bus, with drives and sensors that stand there too, simulated or real. Its time
// is that of the wall. The drive-enable line of a board is no part of a bus: nobody hears of it here, and
// whoever builds the robot gives the drives another one.
class FirmwareProcess {
 public:
  // Storage as make_storage_contents makes it, in a file if one is named (FlashMemory). The transport must
  // outlive this.
  FirmwareProcess(std::span<const std::byte> storage_contents, sim::Transport& transport,
                  const std::filesystem::path& storage_file = {})
      : host_(storage_contents, storage_file, hal::CanSensors::kNodes), transport_(transport) {}

  // Once a millisecond; every tenth call is a tick. Microseconds since the start.
  void service(std::uint64_t now_us);

  std::uint64_t frames_lost() const { return frames_lost_; }  // for which the bus had no room
  bool drive_enabled() const { return output_.drive_enabled; }
  // It has found another controller on the bus, and does nothing more before it is told to reset.
  bool gave_way() const {
    const auto& behaviour = host_.values().behaviour;
    return behaviour.state == behaviour::State::kFault &&
           behaviour.reason == behaviour::Reason::kSecondMaster;
  }

 private:
  void receive(std::uint64_t now_us);
  void send(const hal::CanFrame& frame);

  InProcessHost host_;
  sim::Transport& transport_;
  hal::CanSensors sensors_;
  hal::BatchInput input_;
  hal::BatchOutput output_;
  std::uint64_t services_ = 0;
  std::uint64_t frames_lost_ = 0;
};

}  // namespace koboshi::simulation
