#include "studio/gamepad/held_walk.h"

#include <utility>

namespace koboshi::studio {

void HeldWalk::hold(const Eigen::Vector3d& velocity) {
  changed_ = changed_ || !held_ || *held_ != velocity;
  held_ = velocity;
  stop_due_ = false;
}

void HeldWalk::release() {
  if (!held_) return;
  held_.reset();
  stop_due_ = true;
}

std::optional<simulation::Command> HeldWalk::due(std::uint64_t now_us) {
  simulation::Command command;
  if (std::exchange(stop_due_, false)) {
    sent_us_.reset();
    command.kind = simulation::Command::Kind::kStop;
    return command;
  }
  const std::uint64_t wait_us = changed_ ? kPeriod_us / 2 : kPeriod_us;
  if (!held_ || (sent_us_ && now_us < *sent_us_ + wait_us)) return std::nullopt;
  sent_us_ = now_us;
  changed_ = false;
  command.kind = simulation::Command::Kind::kWalk;
  command.velocity = *held_;
  return command;
}

}  // namespace koboshi::studio
