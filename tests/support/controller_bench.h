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

inline constexpr std::uint16_t kVelocityIdentifier = 0x301;  // frames that command a velocity

// Storage as a robot leaves the factory: the test robot's model, motion 0 (standing), motion 1 (nods until it
// is stopped), and parameters (factory_values.h).
std::vector<std::byte> factory_storage();
// The same with this item of parameters in place of its own; without one if it is empty.
std::vector<std::byte> factory_storage(std::span<const std::byte> parameters);

// The whole controller on a fake board with a stub for each drive, in zero time and without physics:
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

  // With a factory's storage.
  ControllerBench();

  // Milliseconds of board time: the drives answer what was sent in the last one, the sensors speak, the
  // firmware is served and, each tenth time, ticked.
  void run_ms(int duration_ms);
  // Time in which nothing is called, as if the firmware had been held up.
  void skip_ms(int duration_ms) { now_us_ += static_cast<std::uint64_t>(duration_ms) * 1'000; }
  // False when the state did not come in time.
  bool run_until(behaviour::State state, int limit_ms = 3'000);
  // Booted, enabled and standing.
  bool run_until_standing();
  // Another node of the bus says something to the drives; what they answer, the firmware hears next.
  void tell_drives(const hal::CanFrame& frame);
  // Sends a command frame, as a PC does, and lets the firmware receive it.
  void command(behaviour::Command command, std::int16_t argument = 0);

  const app::ControllerValues& values() const { return controller_->values(); }
  const decltype(app::ControllerValues::behaviour)& now() const { return values().behaviour; }
  const robot::RobotModel& model() const { return controller_->model(); }
  std::uint64_t now_us() const { return now_us_; }
  // What the controller told a joint last.
  fixed::Angle target(std::size_t joint) const;
  // The latest sent frame with this identifier since `sent` was cleared.
  std::optional<hal::CanFrame> last_sent(std::uint16_t identifier) const;

  // Takes the place of the storage's contents, as far as it goes, and starts the firmware anew.
  void restart(std::span<const std::byte> storage = {});

  // --- what a test scripts and looks at ---
  hal::FakeBoard board;
  std::vector<DriveStub> drives;
  std::vector<SentFrame> sent;
  bool imu_speaks = true;
  std::array<bool, 2> ankle_speaks{true, true};
  hal::ImuSample imu_sample;  // upright and at rest

 private:
  void exchange_frames();
  void feed_sensors();

  std::unique_ptr<app::Controller> controller_;
  std::uint64_t now_us_ = 0;
};

}  // namespace koboshi::test
