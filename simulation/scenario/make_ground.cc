#include "simulation/scenario/make_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "sim_board/random/random_stream.h"
#include "sim_board/world/surface_contact.h"

namespace koboshi::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
// Enough waves that no direction dominates.
constexpr std::size_t kWaves = 24;

sim_board::SurfaceDescription apply(const GroundSurface& given, sim_board::SurfaceDescription surface) {
  if (!given.material.empty()) surface.material = given.material;
  if (given.friction) {
    surface.friction = *given.friction;
    surface.friction_second = given.friction_second.value_or(*given.friction);
  }
  if (given.friction_direction_rad) {
    const double angle_rad = *given.friction_direction_rad;
    surface.friction_direction = Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0);
  }
  if (given.softness) {
    const sim_board::Softness soft = sim_board::softness(
        given.softness->stiffness_N_per_m, given.softness->damping_N_s_per_m, surface.reference_step_s);
    surface.error_reduction = soft.error_reduction;
    surface.constraint_force_mixing = soft.constraint_force_mixing;
  }
  surface.bounce = given.bounce.value_or(surface.bounce);
  surface.bounce_threshold_m_per_s =
      given.bounce_threshold_m_per_s.value_or(surface.bounce_threshold_m_per_s);
  surface.slip_m_per_N_s = given.slip_m_per_N_s.value_or(surface.slip_m_per_N_s);
  return surface;
}

struct Wave {
  Vector2d rad_per_m;
  double phase_rad;
};

std::array<Wave, kWaves> draw_waves(double wavelength_m, std::uint64_t seed, std::size_t number) {
  sim_board::RandomStream random(seed, "rough ground " + std::to_string(number));
  std::array<Wave, kWaves> waves{};
  for (Wave& wave : waves) {
    const double direction_rad = kTurn_rad * random.uniform();
    wave.rad_per_m = kTurn_rad / wavelength_m * Vector2d(std::cos(direction_rad), std::sin(direction_rad));
    wave.phase_rad = kTurn_rad * random.uniform();
  }
  return waves;
}

// Smooth transition from 0 at the rim to 1 one wavelength inside.
double rim(const Vector2d& xy_F, const RoughGround& rough) {
  const double inside_m = (0.5 * rough.size_m - xy_F.cwiseAbs()).minCoeff();
  const double part = std::clamp(inside_m / rough.wavelength_m, 0.0, 1.0);
  return part * part * (3.0 - 2.0 * part);
}

sim_board::HeightField make_rough(const RoughGround& rough, std::uint64_t seed, std::size_t number) {
  const std::array<Wave, kWaves> waves = draw_waves(rough.wavelength_m, rough.seed.value_or(seed), number);
  sim_board::HeightField field;
  field.X_WF = rough.X_WF;
  field.size_m = rough.size_m;
  field.columns = std::max(2, 1 + static_cast<int>(std::lround(rough.size_m.x() / rough.spacing_m)));
  field.rows = std::max(2, 1 + static_cast<int>(std::lround(rough.size_m.y() / rough.spacing_m)));
  field.heights_m.assign(static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows), 0.0);
  std::size_t index = 0;
  for (int row = 0; row < field.rows; ++row) {
    for (int column = 0; column < field.columns; ++column, ++index) {
      const Vector2d xy_F = field.point_F(column, row).head<2>();
      for (const Wave& wave : waves)
        field.heights_m[index] += std::cos(wave.rad_per_m.dot(xy_F) + wave.phase_rad);
    }
  }
  const auto [lowest, highest] = std::ranges::minmax(field.heights_m);
  index = 0;
  for (int row = 0; row < field.rows; ++row)
    for (int column = 0; column < field.columns; ++column, ++index)
      field.heights_m[index] = rough.height_m * rim(field.point_F(column, row).head<2>(), rough) *
                               (field.heights_m[index] - lowest) / (highest - lowest);
  return field;
}

// Adds the shapes of a scenario to the ground.
class Builder {
 public:
  Builder(sim_board::GroundDescription& ground, const Isometry3d& X_WG, std::uint64_t seed)
      : ground_(ground), X_WG_(X_WG), seed_(seed) {}

  void add(const GroundShape& shape) {
    surface_ = apply(shape.surface, ground_.surface);
    std::visit(*this, shape.shape);
  }
  void operator()(sim_board::FrictionPatch patch) {
    patch.X_WP = X_WG_ * patch.X_WP;
    patch.surface = surface_;
    ground_.patches.push_back(patch);
  }
  void operator()(sim_board::GroundBox box) {
    box.X_WG = X_WG_ * box.X_WG;
    box.surface = surface_;
    ground_.boxes.push_back(box);
  }
  void operator()(sim_board::HeightField field) {
    field.X_WF = X_WG_ * field.X_WF;
    field.surface = surface_;
    ground_.height_fields.push_back(std::move(field));
  }
  void operator()(const RoughGround& rough) {
    (*this)(make_rough(rough, seed_, ground_.height_fields.size()));
  }

 private:
  sim_board::GroundDescription& ground_;
  const Isometry3d X_WG_;
  const std::uint64_t seed_;
  sim_board::SurfaceDescription surface_;
};

}  // namespace

sim_board::GroundDescription make_ground(const Ground& ground, std::uint64_t seed) {
  const Eigen::AngleAxisd roll(ground.roll_rad, Vector3d::UnitX());
  const Eigen::AngleAxisd pitch(ground.pitch_rad, Vector3d::UnitY());
  const Isometry3d X_WG(pitch * roll);
  sim_board::GroundDescription made;
  made.normal_W = pitch * (roll * Vector3d::UnitZ());
  made.surface = apply(ground, made.surface);
  Builder builder(made, X_WG, seed);
  for (const GroundShape& shape : ground.shapes) builder.add(shape);
  // A plane's friction direction is in world axes; a shape's, which may be inherited, is in its own.
  if (made.surface.friction_direction)
    made.surface.friction_direction = X_WG.linear() * *made.surface.friction_direction;
  return made;
}

}  // namespace koboshi::simulation
