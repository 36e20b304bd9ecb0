#pragma once

#include <array>
#include <cstdint>

#include "firmware/canopen/frame.h"
#include "firmware/canopen/sdo/client.h"
#include "firmware/robot/model.h"

namespace koboshi::drive {

// Writes the torque limits of the drives (CiA 402, object 0x6072) whenever the wanted ones change: a queue
// with one place for each joint, of which the last value counts. One SDO at a time, at most one in each call
// of `process`; the joints take turns. In cyclic operation the PDOs of 20 drives fill 5 ms of each cycle of
// 10 ms, so that all 20 limits take at most 50 ms on a bus that loses no frame. A write without answer is
// repeated when the other joints have had their turn: the loss of a drive is detected elsewhere.
class TorqueLimits {
 public:
  // The drive's full torque, its limit after a reset.
  static constexpr std::uint16_t kFull_permille = 1000;

  // The model must outlive the limits. Sends to `sink` as SDO client.
  TorqueLimits(const robot::RobotModel& model, canopen::FrameSink& sink) : model_(model), client_(sink) {
    reset();
  }

  // All drives are being reset, and have their full torque.
  void reset();
  // This joint's drive has restarted with its full torque: what is wanted is written again.
  void on_boot_up(std::size_t joint);
  // Sets the wanted limit of a joint, 0 to kFull_permille of the rated torque.
  void set(std::size_t joint, std::uint16_t limit_permille);

  void on_frame(const hal::CanFrame& frame) { client_.on_frame(frame); }
  // Evaluates the last write and, if `may_write`, begins the next. Call it at 1 kHz.
  void process(bool may_write, std::uint64_t now_us);

  // Returns whether a write is under way.
  [[nodiscard]] bool busy() const { return client_.state() == canopen::SdoState::kBusy; }
  // Returns the joints whose drives have another limit than the wanted one; bit i: joint i. Those that refuse
  // limits are not among them.
  [[nodiscard]] std::uint32_t pending() const { return pending_; }
  // Returns the joints whose drives have aborted a write since the reset, mostly because they have no object
  // 0x6072; nothing more is written to them. Bit i: joint i.
  [[nodiscard]] std::uint32_t refused() const { return refused_; }

 private:
  void finish();
  void begin(std::uint64_t now_us);
  void compare(std::size_t joint);

  const robot::RobotModel& model_;
  canopen::SdoClient client_;
  std::array<std::uint16_t, robot::kMaxJoints> wanted_permille_{};
  std::array<std::uint16_t, robot::kMaxJoints> written_permille_{};
  std::uint32_t pending_ = 0;
  std::uint32_t refused_ = 0;
  std::size_t joint_ = 0;            // of the last write
  std::uint16_t sent_permille_ = 0;  // in the last write
};

}  // namespace koboshi::drive
