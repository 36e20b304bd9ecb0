#include "firmware/drive/setting.h"

#include <bit>

#include "firmware/fixed/contract.h"

namespace koboshi::drive {

using canopen::SdoState;

void Setting::reset() {
  client_.reset();
  wanted_permille_.fill(kOwn_permille);
  written_permille_.fill(kOwn_permille);
  pending_ = 0;
  refused_ = 0;
  joint_ = robot::kMaxJoints - 1;
}

// An answer to a write from before the restart no longer tells what the drive has.
void Setting::on_boot_up(std::size_t joint) {
  KOBOSHI_ASSERT(joint < model_.joint_count);
  if (busy() && joint_ == joint) client_.reset();
  written_permille_[joint] = kOwn_permille;
  compare(joint);
}

void Setting::set(std::size_t joint, std::uint16_t value_permille) {
  KOBOSHI_ASSERT(joint < model_.joint_count && value_permille <= max_permille_);
  wanted_permille_[joint] = value_permille;
  compare(joint);
}

void Setting::compare(std::size_t joint) {
  const std::uint32_t bit = 1u << joint;
  const bool differs = wanted_permille_[joint] != written_permille_[joint] && (refused_ & bit) == 0;
  pending_ = differs ? pending_ | bit : pending_ & ~bit;
}

void Setting::process(bool may_write, std::uint64_t now_us) {
  client_.process(now_us);
  if (busy()) return;
  if (client_.state() != SdoState::kIdle) finish();
  if (pending_ != 0 && may_write) begin(now_us);
}

void Setting::finish() {
  if (client_.state() == SdoState::kDone) written_permille_[joint_] = sent_permille_;
  if (client_.state() == SdoState::kAborted) refused_ |= 1u << joint_;
  compare(joint_);
  client_.reset();
}

// Takes the next joint of the round. A queue that is full cannot take a request: the next call tries again.
void Setting::begin(std::uint64_t now_us) {
  const std::uint32_t behind = pending_ & ~((2u << joint_) - 1);
  const auto joint = static_cast<std::size_t>(std::countr_zero(behind != 0 ? behind : pending_));
  const std::uint16_t value_permille = wanted_permille_[joint];
  if (!client_.begin_write(model_.joints[joint].drive.node_id, object_, value_permille, sizeof value_permille,
                           now_us))
    return;
  joint_ = joint;
  sent_permille_ = value_permille;
}

}  // namespace koboshi::drive
