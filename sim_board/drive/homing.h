#pragma once

#include <cstdint>

#include "firmware/canopen/cia402.h"

namespace koboshi::sim_board {

// Homing mode, CiA 402-2, by the methods that do not move the shaft: 35 and 37, where the position that the
// shaft has becomes home. A rising edge of controlword bit 4 starts it.
class Homing {
 public:
  // The mode or the operation begins: nothing is started. A bit 4 that is already set starts nothing.
  void restart(std::uint16_t controlword) {
    controlword_ = controlword;
    outcome_ = Outcome::kNotStarted;
  }
  // One loop in operation enabled. True where the shaft is at home now; `readable`: its position is known.
  [[nodiscard]] bool step(std::uint16_t controlword, bool readable) {
    const bool starts = (controlword & ~controlword_ & canopen::cia402::kStartHoming) != 0;
    controlword_ = controlword;
    if (!starts) return false;
    outcome_ = readable ? Outcome::kAttained : Outcome::kFailed;
    return readable;
  }
  // Bits 10, 12 and 13 of the statusword.
  std::uint16_t bits() const {
    using namespace canopen::cia402;
    switch (outcome_) {
      case Outcome::kNotStarted:
        return kTargetReached;
      case Outcome::kAttained:
        return kTargetReached | kHomingAttained;
      case Outcome::kFailed:
        return kTargetReached | kHomingError;
    }
    return 0;
  }

 private:
  enum class Outcome : std::uint8_t { kNotStarted, kAttained, kFailed };

  std::uint16_t controlword_ = 0;
  Outcome outcome_ = Outcome::kNotStarted;
};

}  // namespace koboshi::sim_board
