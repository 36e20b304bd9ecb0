#pragma once

#include <cstdint>
#include <span>

#include "firmware/behaviour/parameters.h"
#include "firmware/drive/drive_group.h"
#include "firmware/fixed/units.h"
#include "firmware/robot/model.h"

namespace koboshi::behaviour {

// The load of the drives, by joint, when one of them reads the supply.
struct DriveLoad {
  std::span<const robot::Joint> joints{};
  std::span<const std::int16_t>
      torques_permille{};                  // 0x6077, of the rated torque; positive as the shaft turns
  std::span<const fixed::Angle> angles{};  // of the joints, and one control cycle earlier
  std::span<const fixed::Angle> last_angles{};
};

// Estimates the open-circuit voltage of the supply from the readings of the drives and their load, and
// decides whether it is low. A sag that the load explains does not count.
//
// The current I of all drives flows through the internal resistance R of the supply (cells, switch, wires),
// and no bridge loses power. A motor takes R_m i^2 + k w i:
//
//   V_oc = V + R I,  I = sum (R_m i^2 + k w i) / V
//
// The rated torque of a drive is the stall torque at the rated voltage V_n: t = i R_m / V_n for the torque as
// a share of it (0x6077). With the speed without load, w_0 = V_n / k:
//
//   V_oc = V + S (V_n / V) sum t (t + w / w_0),  S = R V_n / R_m
//
// S is the parameter `stalled_drive_sag_mV`, the sag while one drive stalls at its rated voltage, and w_0 the
// parameter `no_load_speed`. The factor V_n / V is taken as 1: with a supply 20 % below V_n the sag is 25 %
// larger than the estimate. Motors that brake charge the supply; the sag is then negative. All drives count
// as of one kind. docs/decision/0035-low-supply.md has the errors of the estimate in the simulator.
class SupplyGuard {
 public:
  // Readings that must be low: two seconds. Set by hand (2026-11-22): longer than the transients of a step.
  static constexpr std::uint16_t kReadings = 2'000'000 / drive::DriveGroup::kSupplyPeriod_us;
  // A supply that was low is so until it is above the limit by this share of it, 1 / 2^5 or 3 %: 197 mV of
  // 6.3 V. Set by hand (2026-11-27), above the errors of a drive's voltmeter (scale 1 %, offset 20 mV) and
  // of the estimate, so that the end of the load does not make an empty battery full again.
  static constexpr unsigned kHysteresisShift = 5;

  // Takes one reading of a drive, in mV, and the load in the same cycle. A supply becomes low when the
  // readings below `supply_low_mV` exceed those within the hysteresis by kReadings. A reading above the
  // hysteresis starts the count anew. It is no longer low after kReadings in a row above the hysteresis.
  // O(drives); call it with each reading only.
  void update(const PowerParameters& parameters, std::uint32_t reading_mV, const DriveLoad& load);
  // As at power-on: no reading yet.
  void reset() { *this = {}; }

  [[nodiscard]] bool low() const { return low_; }
  // The last reading: the open-circuit voltage, and the sag by the load; 0 before the first. They
  // saturate.
  [[nodiscard]] std::uint16_t open_circuit_mV() const { return open_circuit_mV_; }
  [[nodiscard]] std::int16_t load_sag_mV() const { return load_sag_mV_; }

 private:
  void judge(std::uint32_t low_mV);

  std::uint16_t open_circuit_mV_ = 0;
  std::int16_t load_sag_mV_ = 0;
  std::uint16_t count_ = 0;  // readings that speak against the present verdict
  bool low_ = false;
};

}  // namespace koboshi::behaviour
