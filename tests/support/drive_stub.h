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

// A servo drive at the other end of a fake bus: it answers SDO requests, follows controlwords without delay
// and is always where it was told to be. A test changes its members to make it misbehave.
class DriveStub {
 public:
  using State = canopen::cia402::State;

  explicit DriveStub(const robot::Drive& drive);

  // A frame from the controller; appends what the drive says to it. PDOs are those that the controller maps:
  // controlword and target, and at SYNC statusword, position and torque.
  void on_frame(const hal::CanFrame& frame, std::vector<hal::CanFrame>& answers);
  // One cycle without a bus: obeys the words and returns the statusword.
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

  // --- what a test scripts and looks at ---
  bool beats = true;    // false: produces no heartbeat
  bool hangs = false;   // neither hears nor speaks
  bool enables = true;  // false: stays in ready to switch on
  bool answers_sdo = true;
  bool follows = true;                            // false: has left cyclic synchronous position mode
  std::optional<canopen::ObjectAddress> refuses;  // the request for this object is aborted
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
