#pragma once

#include <functional>
#include <vector>

#include "lab/validate/validation.h"
#include "sim_board/description/description.h"

namespace koboshi::lab {

// A servo that turns a small link without gravity.
struct ServoTrial {
  std::function<double(double time_s)> target_rad = [](double) { return 0.0; };
  double load_Nm = 0.0;  // external torque on the output
  double duration_s = 0.5;
  double link_inertia_kg_m2 = 1e-4;
  int encoder_bits = 20;
  sim_board::ServoDescription servo{};  // only its BAM M1 parameters count
};

// At each millisecond, when the drive's loop runs.
struct ServoMotion {
  std::vector<double> time_s;
  std::vector<double> position_rad;
  std::vector<double> speed_rad_per_s;
};

// Simulates the trial with sim_board::Servo in a world.
[[nodiscard]] ServoMotion simulated(const ServoTrial& trial, const ValidationSetup& setup);

// Integrates the equations of Rhoban BAM (arXiv 2410.08650), friction model M1, in Runge-Kutta steps of 2 us:
//   (J + J_link) w' = kt (V - kt w)/R - Kv w - Kc sgn(w) + load,  V = clip(k (target - measured), supply),
// V held for a millisecond and the measured angle rounded to an encoder's count.
[[nodiscard]] ServoMotion reference(const ServoTrial& trial);

// Steady speed at the full supply against a load: w = (kt V/R + load - Kc)/(kt^2/R + Kv), while it turns
// forwards.
[[nodiscard]] double steady_speed_rad_per_s(const sim_board::ServoDescription& servo, double load_Nm);

}  // namespace koboshi::lab
