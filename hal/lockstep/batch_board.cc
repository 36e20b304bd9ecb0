#include "hal/lockstep/batch_board.h"

#include <algorithm>

namespace koboshi::hal {
namespace {

std::uint16_t saturating_sum(std::uint16_t a, std::uint16_t b) {
  return static_cast<std::uint16_t>(std::min<std::uint32_t>(std::uint32_t{a} + b, 0xFFFF));
}

}  // namespace

void BatchBoard::begin(const BatchInput& input) {
  for (const CanFrame& frame : input.frames.view()) {
    if (!frames_.push(frame)) frames_lost_ = saturating_sum(frames_lost_, 1);
  }
  for (const ImuSample& sample : input.imu.view()) {
    if (!imu_.push(sample)) samples_lost_ = saturating_sum(samples_lost_, 1);
  }
  for (std::size_t side = 0; side < ankles_.size(); ++side) {
    if (!input.ankle_fresh[side]) continue;
    ankle_fresh_[side] = true;
    ankles_[side] = input.ankles[side];
  }
  status_ = input.can_status;
  status_.receive_overruns = saturating_sum(status_.receive_overruns, frames_lost_);
  imu_overruns_ = saturating_sum(input.imu_overruns, samples_lost_);
  transmit_space_ = input.transmit_space;
  transmit_pending_ = input.transmit_pending;
  output_.frames.clear();
  output_.recover = false;
  output_.watchdog_kicked = false;
}

bool BatchBoard::transmit(const CanFrame& frame) {
  std::uint16_t& space = transmit_space_[transmit_fifo(frame)];
  if (space == 0 || !output_.frames.push(frame)) return false;
  --space;
  transmit_pending_[transmit_fifo(frame)] = true;
  return true;
}

std::size_t BatchBoard::transmit_space(TransmitFifo fifo) const {
  const std::size_t room = BatchOutput::kMaxFrames - output_.frames.size;
  return std::min(room, std::size_t{transmit_space_[fifo]});
}

void BatchBoard::recover() {
  if (status_.state == CanErrorState::kBusOff) output_.recover = true;
}

bool BatchBoard::read(Side side, AnkleSample& sample) {
  const auto index = static_cast<std::size_t>(side);
  if (!ankle_fresh_[index]) return false;
  ankle_fresh_[index] = false;
  sample = ankles_[index];
  return true;
}

}  // namespace koboshi::hal
