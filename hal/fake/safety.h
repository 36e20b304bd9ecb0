#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/port/safety.h"

namespace koboshi::hal {

// A watchdog that never expires and records when it was kicked.
class FakeWatchdog final : public WatchdogPort {
 public:
  [[nodiscard]] int kicks() const { return kicks_; }
  // Returns the time of the last kick; nothing before the first.
  [[nodiscard]] std::optional<std::uint64_t> last_kick_us() const { return last_kick_us_; }

  void kick(std::uint64_t now_us) override {
    ++kicks_;
    last_kick_us_ = now_us;
  }

 private:
  int kicks_ = 0;
  std::optional<std::uint64_t> last_kick_us_;
};

// The drive-enable line, low until the firmware raises it.
class FakeDriveEnable final : public DriveEnablePort {
 public:
  [[nodiscard]] bool enabled() const { return enabled_; }
  // Returns the levels to which the line has changed, in order. Setting the present level is not a change.
  [[nodiscard]] const std::vector<bool>& changes() const { return changes_; }

  void set(bool enabled) override {
    if (enabled != enabled_) changes_.push_back(enabled);
    enabled_ = enabled;
  }

 private:
  bool enabled_ = false;
  std::vector<bool> changes_;
};

}  // namespace koboshi::hal
