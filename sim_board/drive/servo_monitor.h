#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/emergency.h"
#include "sim_board/drive/debounce.h"
#include "sim_board/servo/servo.h"

namespace koboshi::sim_board {

// Detects the faults of a drive's own hardware.
class ServoMonitor {
 public:
  // Share of the nominal supply at which the gate drivers of a bridge give up: about a half.
  static constexpr double kLowestSupplyShare = 0.5;
  // Longer than the sag of a supply while a motor starts, shorter than a fall.
  static constexpr std::uint64_t kUnderVoltageTime_us = 10'000;
  // A drive holds its own current at the limit; above it goes only what the shaft generates when it is driven
  // from outside faster than the supply can oppose.
  static constexpr double kOverCurrentShare = 1.2;
  static constexpr std::uint64_t kOverCurrentTime_us = 20'000;

  struct Fault {
    std::uint16_t error_code;
    std::uint8_t register_bits;
  };

  explicit ServoMonitor(const ServoDescription& servo)
      : lowest_supply_V_(kLowestSupplyShare * servo.supply_V),
        highest_current_A_(kOverCurrentShare * servo.current_limit_A) {}

  // One loop. Supply and current matter only while the drive makes torque.
  std::optional<Fault> step(const Servo& servo, bool makes_torque, std::uint64_t now_us) {
    namespace cia402 = canopen::cia402;
    namespace error_register = canopen::error_register;
    const bool low = low_supply_.step(makes_torque && supply_is_low(servo), now_us, kUnderVoltageTime_us);
    const bool high = high_current_.step(makes_torque && std::abs(servo.current_A()) > highest_current_A_,
                                         now_us, kOverCurrentTime_us);
    if (servo.encoder_broken()) return Fault{cia402::kErrorEncoder, error_register::kProfile};
    if (servo.winding().too_hot()) return Fault{cia402::kErrorTemperature, error_register::kTemperature};
    if (low) return Fault{cia402::kErrorUnderVoltage, error_register::kVoltage};
    if (high) return Fault{cia402::kErrorOverCurrent, error_register::kCurrent};
    return std::nullopt;
  }

  // Whether the bridge has a supply that it can work with.
  bool supplied(const Servo& servo) const { return !supply_is_low(servo); }
  // A cause that is still there: no reset of a fault.
  bool forbids_reset(const Servo& servo) const {
    return servo.encoder_broken() || servo.winding().too_hot() || supply_is_low(servo);
  }

 private:
  bool supply_is_low(const Servo& servo) const { return servo.supply_V() < lowest_supply_V_; }

  double lowest_supply_V_;
  double highest_current_A_;  // infinite where the servo has no limit
  Debounce low_supply_;
  Debounce high_current_;
};

}  // namespace koboshi::sim_board
