// An external board. The firmware boots on it and, without robot model and drives, reports both errors on the
// bus.

#include <cstddef>
#include <cstdio>
#include <vector>

#include "firmware/app/controller.h"
#include "hal/port/board.h"

namespace {

namespace hal = koboshi::hal;

class Can final : public hal::CanPort {
 public:
  bool receive(hal::CanFrame&) override { return false; }
  bool transmit(const hal::CanFrame& frame) override {
    sent.push_back(frame);
    return true;
  }
  std::size_t transmit_space(hal::TransmitFifo) const override { return 32; }
  bool transmit_pending(hal::TransmitFifo) const override { return false; }
  hal::CanStatus status() const override { return {}; }
  void recover() override {}

  std::vector<hal::CanFrame> sent;
};

class NoSensors final : public hal::ImuPort, public hal::AnklePort {
 public:
  bool read(hal::ImuSample&) override { return false; }
  std::uint16_t overruns() const override { return 0; }
  bool read(hal::Side, hal::AnkleSample&) override { return false; }
};

// Reads as erased; writing fails.
class EmptyFlash final : public hal::StoragePort {
 public:
  std::span<const std::byte> contents() const override { return contents_; }
  std::size_t sector_size_bytes() const override { return 1024; }
  bool begin_erase(std::size_t) override { return false; }
  bool begin_write(std::size_t, std::span<const std::byte>) override { return false; }
  hal::StorageState state() const override { return hal::StorageState::kIdle; }

 private:
  std::vector<std::byte> contents_ = std::vector<std::byte>(std::size_t{256} * 1024, std::byte{0xFF});
};

class Safety final : public hal::WatchdogPort, public hal::DriveEnablePort {
 public:
  void kick(std::uint64_t) override { ++kicks; }
  void set(bool enabled) override { torque = torque || enabled; }

  int kicks = 0;
  bool torque = false;
};

}  // namespace

int main() {
  Can can;
  NoSensors sensors;
  EmptyFlash flash;
  Safety safety;
  const hal::Board board{.can = can,
                         .imu = sensors,
                         .ankles = sensors,
                         .storage = flash,
                         .watchdog = safety,
                         .drive_enable = safety};
  koboshi::app::Controller controller(board);
  for (std::uint64_t now_us = 0; now_us < 500'000; now_us += 1'000) {
    controller.service(now_us);
    if (now_us % koboshi::app::Controller::kTick_us == 0) controller.tick(now_us);
  }
  const bool booted_up =
      !can.sent.empty() && can.sent.front().identifier == 0x701 && can.sent.front().data[0] == 0;
  const auto& behaviour = controller.values().behaviour;
  std::printf("%zu frames, state %d, reason %d\n", can.sent.size(), static_cast<int>(behaviour.state),
              static_cast<int>(behaviour.reason));
  const bool in_fault = behaviour.state == koboshi::app::State::kFault;
  return booted_up && in_fault && safety.kicks == 500 && !safety.torque ? 0 : 1;
}
