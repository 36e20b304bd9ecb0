#include "sim_board/world/surface_contact.h"

#include <algorithm>

namespace koboshi::sim {
namespace {

// Below this the contact rows of one foot depend on each other to the last digit.
constexpr double kLeastForceMixing = 1e-9;
// A pure spring (ERP 1) still needs some damping to have an inverse.
constexpr double kLargestErrorReduction = 0.999;
constexpr double kLeastErrorReduction = 1e-6;

struct Compliance {
  double spring_m_per_N = 0.0;    // 1/kp
  double damper_m_per_N_s = 0.0;  // 1/kd
};

Compliance compliance(const SurfaceDescription& surface) {
  const double cfm = std::max(surface.constraint_force_mixing, kLeastForceMixing);
  const double erp = std::clamp(surface.error_reduction, kLeastErrorReduction, kLargestErrorReduction);
  return {surface.reference_step_s * cfm / erp, cfm / (1.0 - erp)};
}

}  // namespace

Softness softness(double stiffness, double damping, double step_s) {
  const double step_stiffness = step_s * stiffness;
  return {step_stiffness / (step_stiffness + damping), 1.0 / (step_stiffness + damping)};
}

SurfaceContact meet(const SurfaceDescription& one, const SurfaceDescription& other, double step_s) {
  const Compliance a = compliance(one);
  const Compliance b = compliance(other);
  const SurfaceDescription& bouncier = one.bounce >= other.bounce ? one : other;
  return {.friction = std::min(one.friction, other.friction),
          .friction_second = std::min(one.friction_second, other.friction_second),
          .bounce = bouncier.bounce,
          .bounce_threshold_m_per_s = bouncier.bounce_threshold_m_per_s,
          .softness = softness(1.0 / (a.spring_m_per_N + b.spring_m_per_N),
                               1.0 / (a.damper_m_per_N_s + b.damper_m_per_N_s), step_s)};
}

}  // namespace koboshi::sim
