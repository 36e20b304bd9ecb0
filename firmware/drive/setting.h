#pragma once

#include <array>
#include <cstdint>

#include "firmware/canopen/frame.h"
#include "firmware/canopen/sdo/client.h"
#include "firmware/robot/model.h"

namespace koboshi::drive {

// A setting of which each drive has one, an object of 16 bits in 0.001 of the drive's own value: the torque
// limit (CiA 402, object 0x6072) or the gain of the position loop (0x60FB:1). Writes it whenever the wanted
// value changes: a queue with one place for each joint, of which the last value counts. One SDO at a time, at
// most one in each call of `process`; the joints take turns. In cyclic operation the PDOs of 20 drives fill
// 5 ms of each cycle of 10 ms, so that all 20 values take at most 50 ms on a bus that loses no frame. A write
// without answer is repeated when the other joints have had their turn: the loss of a drive is detected
// elsewhere.
class Setting {
 public:
  // The drive's own value, which it has after a reset.
  static constexpr std::uint16_t kOwn_permille = 1000;

  // The model must outlive the setting. `object`: of every drive. No value exceeds `max_permille`. Sends to
  // `sink` as SDO client.
  Setting(const robot::RobotModel& model, canopen::ObjectAddress object, std::uint16_t max_permille,
          canopen::FrameSink& sink)
      : model_(model), object_(object), max_permille_(max_permille), client_(sink) {
    reset();
  }

  // All drives are being reset, and have their own value.
  void reset();
  // This joint's drive has restarted with its own value: what is wanted is written again.
  void on_boot_up(std::size_t joint);
  // Sets the wanted value of a joint, at most the `max_permille` of the constructor.
  void set(std::size_t joint, std::uint16_t value_permille);

  void on_frame(const hal::CanFrame& frame) { client_.on_frame(frame); }
  // Evaluates the last write and, if `may_write`, begins the next. Call it at 1 kHz.
  void process(bool may_write, std::uint64_t now_us);

  // Returns whether a write is under way.
  [[nodiscard]] bool busy() const { return client_.state() == canopen::SdoState::kBusy; }
  // Returns the joints whose drives have another value than the wanted one; bit i: joint i. Those that refuse
  // the setting are not among them.
  [[nodiscard]] std::uint32_t pending() const { return pending_; }
  // Returns the joints whose drives have aborted a write since the reset, mostly because they have no such
  // object; nothing more is written to them. Bit i: joint i.
  [[nodiscard]] std::uint32_t refused() const { return refused_; }

 private:
  void finish();
  void begin(std::uint64_t now_us);
  void compare(std::size_t joint);

  const robot::RobotModel& model_;
  const canopen::ObjectAddress object_;
  const std::uint16_t max_permille_;
  canopen::SdoClient client_;
  std::array<std::uint16_t, robot::kMaxJoints> wanted_permille_{};
  std::array<std::uint16_t, robot::kMaxJoints> written_permille_{};
  std::uint32_t pending_ = 0;
  std::uint32_t refused_ = 0;
  std::size_t joint_ = 0;            // of the last write
  std::uint16_t sent_permille_ = 0;  // in the last write
};

}  // namespace koboshi::drive
