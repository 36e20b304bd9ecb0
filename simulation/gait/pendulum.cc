#include "simulation/gait/pendulum.h"

#include <cmath>

#include "sim_board/world/gravity.h"

namespace koboshi::simulation {

Pendulum::Pendulum(double height_m) : time_constant_s_(std::sqrt(height_m / sim_board::kGravity_m_per_s2)) {}

PendulumState Pendulum::advance(const PendulumState& state, const ZmpPiece& zmp, double time_s) const {
  const double Tc = time_constant_s_;
  const double cosh = std::cosh(time_s / Tc);
  const double sinh = std::sinh(time_s / Tc);
  const Eigen::Vector2d zmp_speed = (zmp.to_m - zmp.from_m) / zmp.duration_s;
  const Eigen::Vector2d distance = state.position_m - zmp.from_m;
  const Eigen::Vector2d speed = state.velocity_m_per_s - zmp_speed;
  return {zmp.at(time_s) + distance * cosh + Tc * speed * sinh,
          zmp_speed + distance * (sinh / Tc) + speed * cosh};
}

}  // namespace koboshi::simulation
