#include "firmware/policy/residual.h"

#include <algorithm>

#include "firmware/fixed/saturating.h"

namespace koboshi::policy {
namespace {

// Returns `from`, moved towards `to` by at most `step`. Offsets are at most kMaxOffset: no wrapping.
fixed::Angle moved(fixed::Angle from, fixed::Angle to, fixed::Angle step) {
  return from + std::clamp(to - from, -step, step);
}

}  // namespace

void Residual::advance(const Policy& policy, const Observation& seen) {
  if (cause_ == Cause::kNone) evaluate(policy, seen);
  if (deviates_) add_deviations(policy);
  if (cause_ != Cause::kNone) wanted_ = {};
  move_offsets(policy);
}

void Residual::retreat(const Policy& policy) {
  cause_ = Cause::kNone;
  outside_ticks_ = 0;
  wanted_ = {};
  signals_.forget();
  move_offsets(policy);
}

void Residual::reset() {
  cause_ = Cause::kNone;
  outside_ticks_ = 0;
  active_ = false;
  offsets_ = {};
  signals_.forget();
}

void Residual::evaluate(const Policy& policy, const Observation& seen) {
  for (std::size_t i = 0; i < policy.output_count(); ++i) signals_.set_output(i, offsets_[i]);
  signals_.update(seen);
  const std::size_t outside = policy.normalise(signals_.values(), a_);
  const Activations& out = policy.run(a_, b_);
  std::size_t beyond = policy.output_count();
  for (std::size_t i = 0; i < policy.output_count(); ++i) {
    const Output output = policy.output(i);
    const auto offset = fixed::Angle::from_raw(out.values[i] * output.scale);
    wanted_[i] = std::clamp(offset, -output.bound, output.bound);
    if (wanted_[i] != offset) beyond = std::min(beyond, i);
  }
  if (outside < policy.input_count()) return watch(policy, Cause::kInputOutOfRange, outside);
  if (beyond < policy.output_count()) return watch(policy, Cause::kOutputOutOfRange, beyond);
  outside_ticks_ = 0;
}

void Residual::watch(const Policy& policy, Cause cause, std::size_t index) {
  if (++outside_ticks_ <= policy.patience_ticks()) return;
  cause_ = cause;
  cause_index_ = static_cast<std::uint8_t>(index);
}

// Both are at most kMaxOffset: no wrapping.
void Residual::add_deviations(const Policy& policy) {
  for (std::size_t i = 0; i < policy.output_count(); ++i) {
    const fixed::Angle bound = policy.output(i).bound;
    wanted_[i] = std::clamp(wanted_[i] + std::clamp(deviations_[i], -kMaxOffset, kMaxOffset), -bound, bound);
  }
}

void Residual::move_offsets(const Policy& policy) {
  count_ = static_cast<std::uint8_t>(policy.output_count());
  active_ = false;
  for (std::size_t i = 0; i < count_; ++i) {
    const Output output = policy.output(i);
    joints_[i] = output.joint;
    offsets_[i] = moved(offsets_[i], wanted_[i], output.rate);
    active_ = active_ || offsets_[i] != fixed::Angle();
  }
}

void Residual::add_to(std::span<fixed::Angle> targets) const {
  for (std::size_t i = 0; i < count_; ++i) {
    fixed::Angle& target = targets[joints_[i]];
    target = fixed::Angle::from_raw(fixed::add_saturated(target.raw(), offsets_[i].raw()));
  }
}

}  // namespace koboshi::policy
