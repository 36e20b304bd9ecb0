#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "sim_board/drive/debounce.h"
#include "sim_board/drive/drive_dictionary.h"

namespace koboshi::sim_board {

// Compares the shaft with what is asked of it (CiA 402-2, position control function): the following error of
// the demand, and whether a target is reached.
class PositionWatch {
 public:
  // One loop. `demand` is where the shaft should be now, `target` where it should end; `arrived`: the demand
  // has.
  void step(const DriveValues& values, std::int32_t demand, std::int32_t actual, std::int32_t target,
            bool arrived, std::uint64_t now_us) {
    following_error_ = saturated(std::int64_t{demand} - actual);
    following_fault_ = following_.step(outside(following_error_, values.following_window), now_us,
                                       1'000u * values.following_timeout_ms);
    const bool on_target =
        arrived && !outside(saturated(std::int64_t{target} - actual), values.position_window);
    target_reached_ = target_.step(on_target, now_us, 1'000u * values.position_window_ms);
  }
  // There is no demand: nothing is to be followed.
  void restart() { *this = {}; }

  std::int32_t following_error() const { return following_error_; }  // 0x60F4: demand - actual
  bool following_fault() const { return following_fault_; }          // outside 0x6065 for longer than 0x6066
  bool target_reached() const { return target_reached_; }

 private:
  static bool outside(std::int32_t error, std::uint32_t window) {
    return window != kWindowOff && std::abs(std::int64_t{error}) > window;
  }
  static std::int32_t saturated(std::int64_t error) {
    using Limits = std::numeric_limits<std::int32_t>;
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(error, Limits::min(), Limits::max()));
  }

  Debounce following_;
  Debounce target_;
  std::int32_t following_error_ = 0;
  bool following_fault_ = false;
  bool target_reached_ = false;
};

}  // namespace koboshi::sim_board
