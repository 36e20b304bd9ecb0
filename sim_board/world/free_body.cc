#include "sim_board/world/free_body.h"

#include <cmath>
#include <stdexcept>

namespace koboshi::sim_board {

Eigen::Vector3d FreeBodyDescription::moments_kg_m2() const {
  if (shape == Shape::kSphere) return Eigen::Vector3d::Constant(0.1 * mass_kg * size_m.x() * size_m.x());
  const Eigen::Vector3d squares = size_m.cwiseAbs2();
  return mass_kg / 12.0 * (Eigen::Vector3d::Constant(squares.sum()) - squares);
}

void check(const std::vector<FreeBodyDescription>& bodies) {
  for (const FreeBodyDescription& body : bodies) {
    const double smallest_m =
        body.shape == FreeBodyDescription::Shape::kSphere ? body.size_m.x() : body.size_m.minCoeff();
    const bool good =
        body.mass_kg > 0.0 && smallest_m > 0.0 && body.friction >= 0.0 && body.rolling_friction >= 0.0 &&
        body.bounce >= 0.0 && body.bounce <= 1.0 && body.contact_time_s >= 0.001 && body.size_m.allFinite() &&
        body.X_WF.matrix().allFinite() && body.v_WF_W.allFinite() &&
        std::isfinite(body.mass_kg + body.friction + body.rolling_friction + body.contact_time_s);
    if (!good) throw std::invalid_argument("a free body '" + body.name + "' of no size, mass or stiffness");
  }
}

}  // namespace koboshi::sim_board
