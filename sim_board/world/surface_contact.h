#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// ODE's ERP and CFM of a spring kp and damper kd; they depend on the step h (ODE manual, "How To Use ERP and
// CFM"):
//   ERP = h kp / (h kp + kd),  CFM = 1 / (h kp + kd).
struct Softness {
  double error_reduction = 0.0;          // ERP
  double constraint_force_mixing = 0.0;  // CFM, m/(N s) or rad/(N m s)
};

// Stiffness in N/m or N m/rad, damping in N s/m or N m s/rad; not both zero.
Softness softness(double stiffness, double damping, double step_s);

// Contact of two surfaces in ODE's parameters at one step.
struct SurfaceContact {
  double friction = 0.0;
  double friction_second = 0.0;
  double bounce = 0.0;
  double bounce_threshold_m_per_s = 0.0;
  Softness softness;
  double slip_m_per_N_s = 0.0;

  bool has_direction() const { return friction != friction_second; }
};

// Contact of two materials. Given values replace those computed from the two surfaces.
struct MaterialPair {
  struct Spring {
    double stiffness_N_per_m = 0.0;  // of one contact point
    double damping_N_s_per_m = 0.0;
  };

  std::array<std::string, 2> between;             // in either order
  std::optional<std::array<double, 2>> friction;  // Coulomb's mu in both directions
  std::optional<double> bounce;
  std::optional<double> bounce_threshold_m_per_s;
  std::optional<Spring> spring;
  std::optional<double> slip_m_per_N_s;
};

// A file gives ERP and CFM at its reference step h. The material parameters follow, which do not depend on
// the step:
//   1/kp = h CFM / ERP,  1/kd = CFM / (1 - ERP).
// Two surfaces are in series: their compliances 1/kp and 1/kd add, and so do their slips. Friction is the
// smaller value, bounce and its threshold are those of the bouncier surface. A rigid surface (CFM 0) is
// treated as CFM 1e-9. A matching material pair overrides these values.
SurfaceContact contact_between(const SurfaceDescription& one, const SurfaceDescription& other, double step_s,
                               std::span<const MaterialPair> pairs = {});

}  // namespace koboshi::sim_board
