#include "sim_board/world/surface_contact.h"

#include <algorithm>

namespace koboshi::sim_board {
namespace {

// Lower bound of CFM: below it the contact rows of one foot are numerically dependent.
constexpr double kMinForceMixing = 1e-9;
// Upper bound of ERP: a pure spring (ERP 1) would have no inverse.
constexpr double kMaxErrorReduction = 0.999;
constexpr double kMinErrorReduction = 1e-6;

struct Compliance {
  double spring_m_per_N = 0.0;    // 1/kp
  double damper_m_per_N_s = 0.0;  // 1/kd
};

Compliance compliance(const SurfaceDescription& surface) {
  const double cfm = std::max(surface.constraint_force_mixing, kMinForceMixing);
  const double erp = std::clamp(surface.error_reduction, kMinErrorReduction, kMaxErrorReduction);
  return {surface.reference_step_s * cfm / erp, cfm / (1.0 - erp)};
}

bool is_between(const MaterialPair& pair, const std::string& one, const std::string& other) {
  return pair.between == std::array{one, other} || pair.between == std::array{other, one};
}

void apply(const MaterialPair& pair, double step_s, SurfaceContact& contact) {
  if (pair.friction) {
    contact.friction = (*pair.friction)[0];
    contact.friction_second = (*pair.friction)[1];
  }
  contact.bounce = pair.bounce.value_or(contact.bounce);
  contact.bounce_threshold_m_per_s = pair.bounce_threshold_m_per_s.value_or(contact.bounce_threshold_m_per_s);
  if (pair.spring)
    contact.softness = softness(pair.spring->stiffness_N_per_m, pair.spring->damping_N_s_per_m, step_s);
  contact.slip_m_per_N_s = pair.slip_m_per_N_s.value_or(contact.slip_m_per_N_s);
}

}  // namespace

Softness softness(double stiffness, double damping, double step_s) {
  const double step_stiffness = step_s * stiffness;
  return {step_stiffness / (step_stiffness + damping), 1.0 / (step_stiffness + damping)};
}

SurfaceContact contact_between(const SurfaceDescription& one, const SurfaceDescription& other, double step_s,
                               std::span<const MaterialPair> pairs) {
  const Compliance a = compliance(one);
  const Compliance b = compliance(other);
  const SurfaceDescription& bouncier = one.bounce >= other.bounce ? one : other;
  SurfaceContact contact{.friction = std::min(one.friction, other.friction),
                         .friction_second = std::min(one.friction_second, other.friction_second),
                         .bounce = bouncier.bounce,
                         .bounce_threshold_m_per_s = bouncier.bounce_threshold_m_per_s,
                         .softness = softness(1.0 / (a.spring_m_per_N + b.spring_m_per_N),
                                              1.0 / (a.damper_m_per_N_s + b.damper_m_per_N_s), step_s),
                         .slip_m_per_N_s = one.slip_m_per_N_s + other.slip_m_per_N_s};
  for (const MaterialPair& pair : pairs)
    if (is_between(pair, one.material, other.material)) apply(pair, step_s, contact);
  return contact;
}

}  // namespace koboshi::sim_board
