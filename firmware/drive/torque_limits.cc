#include "firmware/drive/torque_limits.h"

#include <bit>

#include "firmware/canopen/cia402.h"
#include "firmware/fixed/contract.h"

namespace koboshi::drive {

using canopen::SdoState;

void TorqueLimits::reset() {
  client_.reset();
  wanted_permille_.fill(kFull_permille);
  written_permille_.fill(kFull_permille);
  pending_ = 0;
  refused_ = 0;
  joint_ = robot::kMaxJoints - 1;
}

// An answer to a write from before the restart no longer tells what the drive has.
void TorqueLimits::on_boot_up(std::size_t joint) {
  KOBOSHI_ASSERT(joint < model_.joint_count);
  if (busy() && joint_ == joint) client_.reset();
  written_permille_[joint] = kFull_permille;
  compare(joint);
}

void TorqueLimits::set(std::size_t joint, std::uint16_t limit_permille) {
  KOBOSHI_ASSERT(joint < model_.joint_count && limit_permille <= kFull_permille);
  wanted_permille_[joint] = limit_permille;
  compare(joint);
}

void TorqueLimits::compare(std::size_t joint) {
  const std::uint32_t bit = 1u << joint;
  const bool differs = wanted_permille_[joint] != written_permille_[joint] && (refused_ & bit) == 0;
  pending_ = differs ? pending_ | bit : pending_ & ~bit;
}

void TorqueLimits::process(bool may_write, std::uint64_t now_us) {
  client_.process(now_us);
  if (busy()) return;
  if (client_.state() != SdoState::kIdle) finish();
  if (pending_ != 0 && may_write) begin(now_us);
}

void TorqueLimits::finish() {
  if (client_.state() == SdoState::kDone) written_permille_[joint_] = sent_permille_;
  if (client_.state() == SdoState::kAborted) refused_ |= 1u << joint_;
  compare(joint_);
  client_.reset();
}

// Takes the next joint of the round. A queue that is full cannot take a request: the next call tries again.
void TorqueLimits::begin(std::uint64_t now_us) {
  const std::uint32_t behind = pending_ & ~((2u << joint_) - 1);
  const auto joint = static_cast<std::size_t>(std::countr_zero(behind != 0 ? behind : pending_));
  const std::uint16_t limit_permille = wanted_permille_[joint];
  if (!client_.begin_write(model_.joints[joint].drive.node_id, {canopen::cia402::kMaxTorque, 0},
                           limit_permille, sizeof limit_permille, now_us))
    return;
  joint_ = joint;
  sent_permille_ = limit_permille;
}

}  // namespace koboshi::drive
