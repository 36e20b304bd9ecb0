#pragma once

#include <algorithm>

#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// The current that motors draw at a supply voltage V: I = conductance_S V - generated_A. A bridge with duty d
// makes of it d V for its motor and takes d i, so that no power is lost: I = d (d V - kt w) / R.
struct SupplyLoad {
  double conductance_S = 0.0;
  double generated_A = 0.0;

  double current_A(double supply_V) const { return conductance_S * supply_V - generated_A; }
  SupplyLoad& operator+=(const SupplyLoad& other) {
    conductance_S += other.conductance_S;
    generated_A += other.generated_A;
    return *this;
  }
};

// The supply of all servos: V = open_circuit_V - R I. Solved together with what they draw at this V: with the
// current of the step before, twenty motors whose conductance exceeds 1/R would make it swing up.
class Battery {
 public:
  explicit Battery(const BatteryDescription& battery)
      : open_circuit_V_(battery.open_circuit_V), internal_resistance_ohm_(battery.internal_resistance_ohm) {}

  double open_circuit_V() const { return open_circuit_V_; }
  void set_open_circuit_V(double open_circuit_V) { open_circuit_V_ = open_circuit_V; }

  double voltage_V(const SupplyLoad& load) const {
    return std::max(0.0, (open_circuit_V_ + internal_resistance_ohm_ * load.generated_A) /
                             (1.0 + internal_resistance_ohm_ * load.conductance_S));
  }

 private:
  double open_circuit_V_;
  double internal_resistance_ohm_;
};

}  // namespace koboshi::sim_board
