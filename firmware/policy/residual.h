#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/fixed/units.h"
#include "firmware/policy/policy.h"
#include "firmware/policy/signals.h"

namespace koboshi::policy {

// Why the watchdog has stopped a policy. The values are those of telemetry.
enum class Cause : std::uint8_t {
  kNone = 0,
  kInputOutOfRange = 1,   // an input outside the range seen in training
  kOutputOutOfRange = 2,  // an output beyond its bound
};

// Adds the outputs of a policy to the targets of the engine: offsets that are bounded, and change by a
// bounded step in each cycle. A watchdog stops the policy when an input or an output has been outside its
// range for more cycles in a row than the policy's patience. The offsets of a policy that has stopped return
// to zero at their rates, and the engine walks on alone.
class Residual {
 public:
  using Deviations = std::array<fixed::Angle, kMaxOutputs>;

  // Runs the policy for one cycle, and moves the offsets towards its outputs. After the watchdog has stopped
  // it, moves them towards zero.
  void advance(const Policy& policy, const Observation& seen);
  // Moves the offsets towards zero, as advance() does once the watchdog has stopped the policy. The next
  // advance() begins anew.
  void retreat(const Policy& policy);
  // Removes all offsets at once, for a robot without torque.
  void reset();
  // Adds these deviations to the outputs of the policy, within their bounds, until the next call. A training
  // explores by them; the watchdog ignores them.
  void deviate(const Deviations& deviations) {
    deviations_ = deviations;
    deviates_ = true;
  }

  // Returns whether an offset is not zero.
  [[nodiscard]] bool active() const { return active_; }
  // Adds the offsets to the targets of their joints; the sums saturate at half a turn. The caller clamps them
  // to the joints' limits.
  void add_to(std::span<fixed::Angle> targets) const;

  // Returns why the watchdog has stopped the policy, and by which input or output.
  [[nodiscard]] Cause cause() const { return cause_; }
  [[nodiscard]] std::uint8_t cause_index() const { return cause_index_; }
  [[nodiscard]] fixed::Angle offset(std::size_t output) const { return offsets_[output]; }
  // Returns the signals of the last evaluation.
  [[nodiscard]] const Signals::Values& signals() const { return signals_.values(); }

 private:
  void evaluate(const Policy& policy, const Observation& seen);
  void watch(const Policy& policy, Cause cause, std::size_t index);
  void add_deviations(const Policy& policy);
  void move_offsets(const Policy& policy);

  Signals signals_;
  Activations a_;
  Activations b_;
  std::array<fixed::Angle, kMaxOutputs> wanted_{};
  std::array<fixed::Angle, kMaxOutputs> offsets_{};
  Deviations deviations_{};
  std::array<std::uint8_t, kMaxOutputs> joints_{};
  std::uint8_t count_ = 0;  // of outputs
  bool active_ = false;
  bool deviates_ = false;
  Cause cause_ = Cause::kNone;
  std::uint8_t cause_index_ = 0;
  std::uint8_t outside_ticks_ = 0;  // in a row
};

}  // namespace koboshi::policy
