#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/app/controller.h"
#include "hal/fake/board.h"
#include "tests/support/drive_stub.h"

namespace koboshi::test {

inline constexpr std::uint16_t kVelocityIdentifier = 0x301;  // COB-ID of velocity commands

// Factory contents of the storage: the test robot's model, motion 0 (standing), motion 1 (nods until stopped)
// and parameters (factory_values.h).
std::vector<std::byte> factory_storage();
// The same contents with these parameters, or without any if the item is empty.
std::vector<std::byte> factory_storage(std::span<const std::byte> parameters,
                                       const std::vector<std::vector<std::byte>>& further_motions = {});
// The same with motion 2, which bends the left knee.
std::vector<std::byte> factory_storage_with_bend();

// A complete controller on a fake board with stub drives, without physics. It runs in zero simulated time:
//
//   ControllerBench bench;                     // powered on
//   bench.drives[3].set_object(0x6079, 0, 5'000);
//   ASSERT_TRUE(bench.run_until(behaviour::State::kLimp));
//   bench.command(behaviour::Command::kEnable);
//   EXPECT_EQ(bench.now().refusal, behaviour::Reason::kSupplyOutOfRange);
//
class ControllerBench {
 public:
  struct SentFrame {
    std::uint64_t time_us;
    hal::CanFrame frame;
  };

  // Starts with the factory contents of the storage.
  ControllerBench();

  // Advances board time. In each millisecond the drives answer the frames of the previous one, the sensors
  // deliver samples, the firmware is serviced and, every tenth millisecond, ticked.
  void run_ms(int duration_ms);
  // Advances time without any call, as if the firmware were blocked.
  void skip_ms(int duration_ms) { now_us_ += static_cast<std::uint64_t>(duration_ms) * 1'000; }
  // Returns false if the controller has not reached `state` after `limit_ms`.
  bool run_until(behaviour::State state, int limit_ms = 3'000);
  // Boots and enables the robot and waits until it stands.
  bool run_until_standing();
  // As above, after the rest in which the controller measures the gyro's bias: the robot may walk.
  bool run_until_ready_to_walk();
  // Sends a frame from another node to the drives. The firmware receives their answers next.
  void tell_drives(const hal::CanFrame& frame);
  // Sends a command frame as a PC does. The firmware receives it in the next millisecond.
  void command(behaviour::Command command, std::int16_t argument = 0);

  const app::ControllerValues& values() const { return controller_->values(); }
  const decltype(app::ControllerValues::behaviour)& now() const { return values().behaviour; }
  const robot::RobotModel& model() const { return controller_->model(); }
  std::uint64_t now_us() const { return now_us_; }
  // The latest target that the controller sent to this joint.
  fixed::Angle target(std::size_t joint) const;
  // Returns the latest frame with this identifier since `sent` was cleared.
  std::optional<hal::CanFrame> last_sent(std::uint16_t identifier) const;

  // Overwrites the beginning of the storage with these contents and restarts the firmware.
  void restart(std::span<const std::byte> storage = {});

  // --- State for tests to set and inspect ---
  hal::FakeBoard board;
  std::vector<DriveStub> drives;
  std::vector<SentFrame> sent;
  bool imu_speaks = true;
  // An operator repeats the velocity of a walk ten times a second (0x1401:5).
  bool velocity_repeats = true;
  std::array<bool, 2> ankle_speaks{true, true};
  hal::ImuSample imu_sample;  // upright and at rest

 private:
  void exchange_frames();
  void feed_sensors();
  void repeat_velocity();

  std::unique_ptr<app::Controller> controller_;
  std::uint64_t now_us_ = 0;
};

}  // namespace koboshi::test
