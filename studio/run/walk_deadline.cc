#include "studio/run/walk_deadline.h"

#include <algorithm>
#include <utility>

#include "sim_board/board/sim_board.h"

namespace koboshi::studio {

std::uint16_t WalkDeadline::deadline_ms() const {
  return *former_ms_ == 0 ? kDeadline_ms : std::min(*former_ms_, kDeadline_ms);
}

simulation::ObjectRequest WalkDeadline::write(std::uint16_t time_ms) {
  return {.number = kNumber,
          .node_id = sim_board::kControllerNode,
          .address = kObject,
          .data = {static_cast<std::uint8_t>(time_ms), static_cast<std::uint8_t>(time_ms >> 8)}};
}

std::optional<simulation::ObjectRequest> WalkDeadline::due(std::uint64_t now_us) {
  if (under_way_ || state_ == State::kRefused || now_us < retry_us_) return std::nullopt;
  if (wanted_ && !former_ms_) {
    under_way_ = true;
    return simulation::ObjectRequest{
        .number = kNumber, .node_id = sim_board::kControllerNode, .address = kObject};
  }
  if (wanted_ ? is_armed() : in_force_ms_ == former_ms_) return std::nullopt;
  // A robot that does not answer is asked again only for a walk.
  if (!wanted_ && !in_force_ms_) return std::nullopt;
  under_way_ = true;
  written_ms_ = wanted_ ? deadline_ms() : *former_ms_;
  return write(written_ms_);
}

bool WalkDeadline::take(const simulation::ObjectAnswer& answer, std::uint64_t now_us) {
  if (answer.number != kNumber) return false;
  if (!std::exchange(under_way_, false)) return true;
  const bool reads = !former_ms_;
  if (answer.is_lost()) {
    if (!reads) in_force_ms_.reset();
    retry_us_ = now_us + kRetry_us;
    state_ = State::kSilent;
  } else if (answer.abort != canopen::AbortCode::kNone || (reads && answer.data.size() != 2)) {
    state_ = State::kRefused;
  } else {
    if (reads) former_ms_ = static_cast<std::uint16_t>(answer.data[0] | answer.data[1] << 8);
    in_force_ms_ = reads ? *former_ms_ : written_ms_;
    state_ = State::kWorks;
  }
  return true;
}

std::optional<simulation::ObjectRequest> WalkDeadline::restoring() const {
  if (!former_ms_ || (in_force_ms_ == former_ms_ && !under_way_)) return std::nullopt;
  return write(*former_ms_);
}

}  // namespace koboshi::studio
