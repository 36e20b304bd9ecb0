#pragma once

#include "sim_board/robot/description.h"

namespace koboshi::sim {

// How two surfaces meet, in ODE's parameters at one step.
struct SurfaceContact {
  double friction = 0.0;
  double friction_second = 0.0;
  double bounce = 0.0;
  double bounce_threshold_m_per_s = 0.0;
  double error_reduction = 0.0;          // ERP
  double constraint_force_mixing = 0.0;  // CFM, m/(N s)
};

// ODE's ERP and CFM of a spring kp and damper kd depend on the step h (ODE manual, 3.8.2):
//   ERP = h kp / (h kp + kd),  CFM = 1 / (h kp + kd).
// A file gives them at its reference step; solved for the material,
//   1/kp = h CFM / ERP,  1/kd = CFM / (1 - ERP),
// which is the same at any step. Two surfaces lie in series: their compliances 1/kp and 1/kd add. Friction is
// that of the more slippery, bounce and its threshold that of the bouncier. A surface given as rigid (CFM 0)
// is taken as CFM 1e-9.
SurfaceContact meet(const SurfaceDescription& one, const SurfaceDescription& other, double step_s);

}  // namespace koboshi::sim
