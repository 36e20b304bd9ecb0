#pragma once

#include <cstdint>
#include <optional>

namespace koboshi::sim_board {

// Whether a condition has held without a break for some time.
class Debounce {
 public:
  // Called once a loop. A duration of 0 is true at once.
  bool step(bool condition, std::uint64_t now_us, std::uint64_t duration_us) {
    if (!condition) {
      since_us_.reset();
    } else if (!since_us_) {
      since_us_ = now_us;
    }
    return since_us_ && now_us - *since_us_ >= duration_us;
  }
  void restart() { since_us_.reset(); }

 private:
  std::optional<std::uint64_t> since_us_;
};

}  // namespace koboshi::sim_board
