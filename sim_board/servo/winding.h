#pragma once

#include <algorithm>
#include <cmath>

#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// The temperature of a motor's copper: C T' = i^2 R - (T - ambient) / Rth, with R = R0 (1 + alpha (T -
// ambient)). Iron, case and neighbours are left out: one node, whose capacity is what a heating curve of the
// servo shows.
class Winding {
 public:
  // `step_s` between calls of `heat`.
  Winding(const ServoDescription& servo, double step_s)
      : description_(servo.winding.value_or(WindingDescription{})),
        cold_resistance_ohm_(servo.resistance_ohm),
        warms_(servo.winding.has_value()),
        temperature_C_(description_.ambient_C) {
    if (!warms_) return;
    keep_ =
        std::exp(-step_s / (description_.thermal_resistance_K_per_W * description_.heat_capacity_J_per_K));
  }

  // One step with this current; exact for one that is constant.
  void heat(double current_A) {
    if (!warms_) return;
    const double loss_W = current_A * current_A * resistance_ohm();
    const double final_C = description_.ambient_C + description_.thermal_resistance_K_per_W * loss_W;
    temperature_C_ = final_C + keep_ * (temperature_C_ - final_C);
    if (temperature_C_ >= description_.shutdown_C) too_hot_ = true;
    if (temperature_C_ <= description_.derating_C) too_hot_ = false;
  }

  // As hot as it may be at most, at once.
  void overheat() {
    temperature_C_ = description_.shutdown_C;
    too_hot_ = true;
  }

  double temperature_C() const { return temperature_C_; }
  double resistance_ohm() const {
    if (!warms_) return cold_resistance_ohm_;
    return cold_resistance_ohm_ *
           (1.0 + description_.copper_per_K * (temperature_C_ - description_.ambient_C));
  }
  // The part of the supply that the drive still gives: 1 up to derating_C, then falling linearly.
  double voltage_share() const {
    if (!warms_ || temperature_C_ <= description_.derating_C) return 1.0;
    const double way =
        (temperature_C_ - description_.derating_C) / (description_.shutdown_C - description_.derating_C);
    return std::lerp(1.0, description_.derated_share, std::min(way, 1.0));
  }
  // From shutdown_C on, until it has cooled to derating_C.
  bool too_hot() const { return too_hot_; }

 private:
  WindingDescription description_;
  double cold_resistance_ohm_;
  bool warms_;
  double keep_ = 1.0;  // of the distance to the final temperature, after a step
  double temperature_C_;
  bool too_hot_ = false;
};

}  // namespace koboshi::sim_board
