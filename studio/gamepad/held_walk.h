#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "simulation/scenario/scenario.h"

namespace koboshi::studio {

// A walk that lasts as long as somebody holds it: the dead man's switch of the operator's controls. Its
// velocity is repeated while it is held, and a stop follows its end.
class HeldWalk {
 public:
  // A quarter of the time after which BusMonitor ends a walk that is not repeated.
  static constexpr std::uint64_t kPeriod_us = 100'000;

  // Walks at this velocity from now on: m/s forward and to the left, rad/s counter-clockwise.
  void hold(const Eigen::Vector3d& velocity);
  // Ends the walk. Without a walk, nothing happens.
  void release();
  bool is_held() const { return held_.has_value(); }

  // Returns the command that is due: a walk at once for a new velocity, but not more often than twice per
  // period, and once per period while held; one stop after the release. Times never decrease.
  [[nodiscard]] std::optional<simulation::Command> due(std::uint64_t now_us);

 private:
  std::optional<Eigen::Vector3d> held_;
  bool changed_ = false;
  bool stop_due_ = false;
  std::optional<std::uint64_t> sent_us_;
};

}  // namespace koboshi::studio
