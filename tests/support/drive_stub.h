#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/dictionary.h"
#include "firmware/robot/model.h"
#include "hal/port/can.h"

namespace koboshi::test {

// An ideal servo drive on a fake bus. It answers SDO requests, obeys controlwords without delay and is always
// at its target, unless its torque limit (0x6072) is zero. Tests change its members to inject faults.
class DriveStub {
 public:
  using State = canopen::cia402::State;

  explicit DriveStub(const robot::Drive& drive);

  // Processes a frame from the controller and appends the drive's answers. PDOs follow the controller's
  // mapping: controlword and target in, and statusword, position and torque out at SYNC.
  void on_frame(const hal::CanFrame& frame, std::vector<hal::CanFrame>& answers);
  // Runs one cycle without a bus: obeys the controlword and returns the statusword.
  std::uint16_t cycle(std::uint16_t controlword, std::int32_t target);

  hal::CanFrame boot_up() const;
  hal::CanFrame heartbeat() const;
  hal::CanFrame emergency(std::uint16_t code) const;
  std::uint32_t object(std::uint16_t index, std::uint8_t subindex) const {
    return objects_.at({index, subindex});
  }
  void set_object(std::uint16_t index, std::uint8_t subindex, std::uint32_t value) {
    objects_[{index, subindex}] = value;
  }
  bool operational() const { return operational_; }

  // --- State for tests to set and inspect ---
  bool beats = true;    // false: sends no heartbeat
  bool hangs = false;   // true: neither receives nor sends
  bool enables = true;  // false: stays in ready to switch on
  bool answers_sdo = true;
  bool follows = true;                            // false: has left cyclic synchronous position mode
  std::optional<canopen::ObjectAddress> refuses;  // aborts SDO requests for this object
  State state = State::kSwitchOnDisabled;
  std::int32_t position = 0;
  std::uint16_t controlword = 0;  // in effect since the last cycle
  std::int32_t target = 0;

 private:
  hal::CanFrame answer(const hal::CanFrame& request);
  void on_nmt(const hal::CanFrame& frame, std::vector<hal::CanFrame>& answers);
  std::uint16_t statusword() const;
  hal::CanFrame cyclic_answer() const;

  std::uint8_t node_id_;
  std::map<std::pair<std::uint16_t, std::uint8_t>, std::uint32_t> objects_;
  bool operational_ = false;
  std::uint16_t next_controlword_ = 0;
  std::int32_t next_target_ = 0;
};

}  // namespace koboshi::test
