#include "studio/view/inertia_marks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mechanics/axes.h"

namespace koboshi::studio {
namespace {

constexpr view::Colour kInertia{0.55F, 0.1F, 0.75F};
constexpr double kRingRadius_m = 0.0006;
constexpr int kRingSides = 24;

}  // namespace

// A uniform ellipsoid with semi-axes a, b, c has moments m (b^2 + c^2) / 5, m (a^2 + c^2) / 5 and
// m (a^2 + b^2) / 5.
std::vector<InertiaEllipsoid> inertia_ellipsoids(const sim_board::RobotDescription& robot) {
  std::vector<InertiaEllipsoid> ellipsoids;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const sim_board::LinkDescription& link = robot.links[i];
    auto [moments, axes] = mechanics::principal_inertia(link.I_LCom_L);
    if (axes.determinant() < 0.0) axes.col(2) = -axes.col(2);
    InertiaEllipsoid ellipsoid{.link = static_cast<int>(i)};
    ellipsoid.X_LE.linear() = axes;
    ellipsoid.X_LE.translation() = link.p_LCom_L;
    for (int axis = 0; axis < 3; ++axis) {
      const double square_m2 = 2.5 * (moments.sum() - 2.0 * moments[axis]) / link.mass_kg;
      ellipsoid.radii_m[axis] = std::sqrt(std::max(square_m2, 0.0));
    }
    ellipsoids.push_back(ellipsoid);
  }
  return ellipsoids;
}

void add_inertia_ellipsoids(view::Marks& marks, std::span<const view::Pose> links,
                            std::span<const InertiaEllipsoid> ellipsoids) {
  for (const InertiaEllipsoid& ellipsoid : ellipsoids) {
    const view::Pose& link = links[static_cast<std::size_t>(ellipsoid.link)];
    const auto point_W_m = [&](int plane, int side) -> Eigen::Vector3d {
      const double angle_rad = 2.0 * std::numbers::pi * side / kRingSides;
      Eigen::Vector3d p_E_m = Eigen::Vector3d::Zero();
      p_E_m[(plane + 1) % 3] = std::cos(angle_rad) * ellipsoid.radii_m[(plane + 1) % 3];
      p_E_m[(plane + 2) % 3] = std::sin(angle_rad) * ellipsoid.radii_m[(plane + 2) % 3];
      return link.p_WL_m.cast<double>() + link.q_WL.cast<double>() * (ellipsoid.X_LE * p_E_m);
    };
    for (int plane = 0; plane < 3; ++plane)
      for (int side = 0; side < kRingSides; ++side)
        view::add_rod(marks, point_W_m(plane, side), point_W_m(plane, side + 1), kRingRadius_m, kInertia);
  }
}

}  // namespace koboshi::studio
