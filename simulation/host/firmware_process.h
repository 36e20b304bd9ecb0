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

// The firmware alone on a bus with simulated or real drives and sensors, in real time. The drive-enable line
// is not part of a bus and has no effect here; a robot on such a bus needs another one for its drives.
class FirmwareProcess {
 public:
  // `storage_contents` is as made by make_storage_contents, kept in a file if one is named (FlashMemory). The
  // transport must outlive this object.
  FirmwareProcess(std::span<const std::byte> storage_contents, sim_board::Transport& transport,
                  const std::filesystem::path& storage_file = {})
      : host_(storage_contents, storage_file, hal::CanSensors::kNodes), transport_(transport) {
    sensors_.set_ankles(host_.model().ankle_kind);
  }

  // Services the firmware; call it once per millisecond. Every tenth call is a tick. `now_us` counts from the
  // start.
  void service(std::uint64_t now_us);

  std::uint64_t frames_lost() const { return frames_lost_; }  // because the bus had no room
  bool drive_enabled() const { return output_.drive_enabled; }
  // Returns whether the controller has detected another one on the bus. It then stays passive until a reset
  // command.
  bool found_second_master() const {
    const auto& behaviour = host_.values().behaviour;
    return behaviour.state == behaviour::State::kFault &&
           behaviour.reason == behaviour::Reason::kSecondMaster;
  }
  // Returns whether it has detected it in its first boot: it has sent nothing to the drives.
  bool has_given_way() const { return !booted_ && found_second_master(); }

 private:
  void receive(std::uint64_t now_us);
  void send(const hal::CanFrame& frame);

  InProcessHost host_;
  sim_board::Transport& transport_;
  hal::CanSensors sensors_;
  hal::BatchInput input_;
  hal::BatchOutput output_;
  bool booted_ = false;  // the robot was ready once
  std::uint64_t services_ = 0;
  std::uint64_t frames_lost_ = 0;
};

}  // namespace koboshi::simulation
