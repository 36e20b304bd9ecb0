#include "firmware/behaviour/supply_guard.h"

#include "firmware/fixed/contract.h"
#include "firmware/fixed/saturating.h"
#include "hal/port/period.h"

namespace koboshi::behaviour {
namespace {

// 2^32 / 10^6, rounded up: a product instead of a division of 64 bits, which takes hundreds of instructions.
// The error is 8e-6 of the sag.
constexpr std::int64_t kPerMillion = 4'295;
constexpr unsigned kPerMillionShift = 32;

constexpr std::int32_t kCycles_per_s = 1'000'000 / hal::kControlPeriod_us;

// Returns the power of the drives, in 10^-6 of that of one that stalls at its rated voltage: the sum of
// t (t + w / w_0). A joint turns by less than half a turn in a cycle. One loop without shifts: a reading adds
// less than 300 instructions of the Cortex-M4 to its cycle, for 20 drives.
std::int32_t power_ppm(const DriveLoad& load, std::int16_t no_load_speed) {
  KOBOSHI_ASSERT(load.joints.size() >= load.torques_permille.size() &&
                 load.angles.size() >= load.torques_permille.size() &&
                 load.last_angles.size() >= load.torques_permille.size());
  std::int64_t squares = 0;     // of 31 numbers of 16 bits: 36 bits
  std::int64_t mechanical = 0;  // sum of t w, in 10^-3 2^-32 turn per cycle: 53 bits
  for (std::size_t i = 0; i < load.torques_permille.size(); ++i) {
    const std::int32_t torque = load.torques_permille[i];
    squares += std::int64_t{torque} * torque;
    const std::int32_t turned_raw = fixed::subtract_wrapped(load.angles[i].raw(), load.last_angles[i].raw());
    mechanical += std::int64_t{load.joints[i].drive.sign * torque} * turned_raw;
  }
  if (no_load_speed <= 0) return fixed::saturate<std::int32_t>(squares);
  // From there to 10^-6 of 2^-12 turn/s. The division comes before the product: it is exact to 1e-4 of a
  // stalled drive.
  constexpr unsigned kShift = 12;
  constexpr std::int32_t kScale = 1'000 * kCycles_per_s / (1 << (32 - 12 - kShift));
  const std::int32_t share = fixed::saturate<std::int32_t>(mechanical >> kShift) / no_load_speed;
  return fixed::saturate<std::int32_t>(squares + std::int64_t{share} * kScale);
}

}  // namespace

void SupplyGuard::update(const PowerParameters& parameters, std::uint32_t reading_mV, const DriveLoad& load) {
  // Products of 31, 16 and 13 bits.
  const std::int64_t sag_mV = std::int64_t{power_ppm(load, parameters.no_load_speed)} *
                                  parameters.stalled_drive_sag_mV * kPerMillion >>
                              kPerMillionShift;
  load_sag_mV_ = fixed::saturate<std::int16_t>(sag_mV);
  open_circuit_mV_ = fixed::saturate<std::uint16_t>(std::int64_t{reading_mV} + load_sag_mV_);
  judge(parameters.supply_low_mV);
}

void SupplyGuard::judge(std::uint32_t low_mV) {
  const bool below = open_circuit_mV_ < low_mV;
  const bool above = open_circuit_mV_ >= low_mV + (low_mV >> kHysteresisShift);
  if (low_ ? above : below) {
    ++count_;
  } else if (low_ || above) {
    count_ = 0;
  } else if (count_ > 0) {
    --count_;
  }
  if (count_ < kReadings) return;
  low_ = !low_;
  count_ = 0;
}

}  // namespace koboshi::behaviour
