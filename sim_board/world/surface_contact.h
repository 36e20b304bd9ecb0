#pragma once

#include "sim_board/robot/description.h"

namespace koboshi::sim {

// ODE's ERP and CFM of a spring kp and damper kd; they depend on the step h (ODE manual, "How To Use ERP and
// CFM"):
//   ERP = h kp / (h kp + kd),  CFM = 1 / (h kp + kd).
struct Softness {
  double error_reduction = 0.0;          // ERP
  double constraint_force_mixing = 0.0;  // CFM, m/(N s) or rad/(N m s)
};

// Stiffness in N/m or N m/rad, damping in N s/m or N m s/rad, not both zero.
Softness softness(double stiffness, double damping, double step_s);

// How two surfaces meet, in ODE's parameters at one step.
struct SurfaceContact {
  double friction = 0.0;
  double friction_second = 0.0;
  double bounce = 0.0;
  double bounce_threshold_m_per_s = 0.0;
  Softness softness;
};

// A file gives ERP and CFM at its reference step h; solved for the material, which is the same at any step,
//   1/kp = h CFM / ERP,  1/kd = CFM / (1 - ERP).
// Two surfaces lie in series: their compliances 1/kp and 1/kd add. Friction is that of the more slippery,
// bounce and its threshold that of the bouncier. A surface given as rigid (CFM 0) is taken as CFM 1e-9.
SurfaceContact meet(const SurfaceDescription& one, const SurfaceDescription& other, double step_s);

}  // namespace koboshi::sim
