#pragma once

#include <cmath>

#include "sim_board/description/description.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// The bound on the dry friction of the gears: what can stop the joint, and holds it while it stands. Rhoban's
// BAM (arXiv 2410.08650; github Rhoban/bam, bam/model.py), models M1 to M6 in one:
//
//   Kc + |Ke te - Km tm| + s (Kcs + |Kes te - Kms tm| + q),   s = exp(-|w / ws|^a)
//   q = Keq te^2 where |te| < |tm|, Kmq tm^2 where |te| > |tm|; 0 where both turn the same way
//
// tm is the motor's torque, te what the robot puts on the output. M1 has Kc alone; M4 equal shares Ke = Km
// and Kes = Kms; M6 all.
class DryFriction {
 public:
  explicit DryFriction(const ServoDescription& servo)
      : coulomb_Nm_(servo.coulomb_friction_Nm),
        stribeck_(servo.stribeck),
        load_(servo.load_friction),
        stribeck_load_(servo.stribeck_load_friction),
        quadratic_per_Nm_(servo.quadratic_load_friction_per_Nm),
        has_stribeck_(stribeck_.friction_Nm > 0.0 || sum(stribeck_load_) > 0.0 ||
                      sum(quadratic_per_Nm_) > 0.0) {}

  double bound_Nm(double motor_Nm, double external_Nm, double speed_rad_per_s) const {
    double bound_Nm = coulomb_Nm_ + gear_load_Nm(load_, motor_Nm, external_Nm);
    if (!has_stribeck_) return bound_Nm;
    const double share =
        std::exp(-std::pow(std::abs(speed_rad_per_s) / stribeck_.speed_rad_per_s, stribeck_.exponent));
    bound_Nm += share * (stribeck_.friction_Nm + gear_load_Nm(stribeck_load_, motor_Nm, external_Nm) +
                         quadratic_Nm(motor_Nm, external_Nm));
    return bound_Nm;
  }

  void apply(double motor_Nm, double external_Nm, double speed_rad_per_s, ServoTorque& torque) const {
    torque.friction_Nm += bound_Nm(motor_Nm, external_Nm, speed_rad_per_s);
  }

 private:
  static double sum(const LoadShares& shares) { return shares.motor + shares.external; }
  static double gear_load_Nm(const LoadShares& shares, double motor_Nm, double external_Nm) {
    return std::abs(shares.external * external_Nm - shares.motor * motor_Nm);
  }
  double quadratic_Nm(double motor_Nm, double external_Nm) const {
    if (motor_Nm * external_Nm > 0.0) return 0.0;
    return std::abs(external_Nm) < std::abs(motor_Nm) ? quadratic_per_Nm_.external * external_Nm * external_Nm
           : std::abs(external_Nm) > std::abs(motor_Nm) ? quadratic_per_Nm_.motor * motor_Nm * motor_Nm
                                                        : 0.0;
  }

  double coulomb_Nm_;
  StribeckDescription stribeck_;
  LoadShares load_;
  LoadShares stribeck_load_;
  LoadShares quadratic_per_Nm_;
  bool has_stribeck_;
};

}  // namespace koboshi::sim_board
