#pragma once

#include <cstdint>
#include <optional>

#include "simulation/scenario/object_access.h"

namespace koboshi::studio {

// Arms the controller's own deadline of the velocity while a walk is held over a bus: the event timer of its
// second RPDO (CiA 301, object 0x1401:05). If no velocity comes within it, the controller ends the walk, also
// when this program has been killed. After the walk the timer has its former value again, so that a silence
// that is meant raises no emergency message.
class WalkDeadline {
 public:
  // Five repetitions of HeldWalk: up to four velocities in a row may be lost. Above
  // BusMonitor::kWalkTimeout_us, so that a window that pauses is dealt with by the monitor alone. Set by hand
  // (2026-11-25).
  static constexpr std::uint16_t kDeadline_ms = 500;
  // From a lost answer to the next access. Set by hand (2026-11-25).
  static constexpr std::uint64_t kRetry_us = 50'000;
  static constexpr canopen::ObjectAddress kObject{0x1401, 5};
  // Number of its requests, above those of ControllerInquiry.
  static constexpr std::uint64_t kNumber = std::uint64_t{16} << 40;

  enum class State : std::uint8_t {
    kUnknown,  // not asked for yet
    kSilent,   // the last request was not answered
    kWorks,
    kRefused,  // the controller does not accept the event timer
  };

  // Wants the deadline, or the former value.
  void arm() { wanted_ = true; }
  void disarm() { wanted_ = false; }
  // Returns the access that is due; take() then gets its answer. Times never decrease.
  [[nodiscard]] std::optional<simulation::ObjectRequest> due(std::uint64_t now_us);
  // Returns whether it is the answer to its access.
  bool take(const simulation::ObjectAnswer& answer, std::uint64_t now_us);
  // The write that restores the former value, if it is not in force; for an end that cannot wait for answers.
  std::optional<simulation::ObjectRequest> restoring() const;

  // Whether a walk may begin: the deadline is armed, or the controller does not accept one.
  bool permits_walk() const { return state_ == State::kRefused || (wanted_ && is_armed()); }
  State state() const { return state_; }

 private:
  bool is_armed() const { return former_ms_ && in_force_ms_ == deadline_ms(); }
  // A deadline that the robot has already is kept if it is shorter.
  std::uint16_t deadline_ms() const;
  static simulation::ObjectRequest write(std::uint16_t time_ms);

  bool wanted_ = false;
  bool under_way_ = false;
  std::uint64_t retry_us_ = 0;                // no access before
  std::optional<std::uint16_t> former_ms_;    // read before the first write
  std::optional<std::uint16_t> in_force_ms_;  // nothing: not known, after a write without an answer
  std::uint16_t written_ms_ = 0;              // by the access under way
  State state_ = State::kUnknown;
};

}  // namespace koboshi::studio
