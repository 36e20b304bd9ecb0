#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace koboshi::mechanics {

// Spatial vectors (Featherstone, "Rigid Body Dynamics Algorithms", 2008, ch. 2), angular part first, in world
// axes about one origin O at rest, common to all bodies:
//   velocity  (w, v_O), where v_O is the velocity of the body's point at O
//   impulse   (moment about O, linear impulse); momentum likewise
using Vector6 = Eigen::Matrix<double, 6, 1>;

inline Vector6 spatial(const Eigen::Vector3d& angular, const Eigen::Vector3d& linear) {
  Vector6 vector;
  vector << angular, linear;
  return vector;
}

// Velocity of a body with angular velocity `w` whose point at `p_O` moves at `v`.
inline Vector6 spatial_velocity(const Eigen::Vector3d& w, const Eigen::Vector3d& p_O,
                                const Eigen::Vector3d& v) {
  return spatial(w, v + p_O.cross(w));
}

// Force or impulse `f` at the point `p_O`. Its product with a velocity is the power; it is therefore also the
// Jacobian of the speed of the point at `p_O` along `f`.
inline Vector6 spatial_force(const Eigen::Vector3d& p_O, const Eigen::Vector3d& f) {
  return spatial(p_O.cross(f), f);
}

// Velocity of the body's point at `p_O`.
inline Eigen::Vector3d velocity_at(const Vector6& velocity, const Eigen::Vector3d& p_O) {
  return velocity.tail<3>() + velocity.head<3>().cross(p_O);
}

// Inertia of rigidly connected masses: maps velocity to momentum (Featherstone, eq. 2.63).
struct SpatialInertia {
  double mass_kg = 0.0;
  Eigen::Vector3d moment_kg_m = Eigen::Vector3d::Zero();  // mass times centre of mass
  Eigen::Matrix3d I_O = Eigen::Matrix3d::Zero();          // about the origin, kg m^2

  SpatialInertia() = default;
  // A body with its centre of mass at `p_OCom` and the inertia `I_Com` about it.
  SpatialInertia(double mass, const Eigen::Vector3d& p_OCom, const Eigen::Matrix3d& I_Com)
      : mass_kg(mass), moment_kg_m(mass * p_OCom), I_O(I_Com) {
    I_O += moment_kg_m.dot(p_OCom) * Eigen::Matrix3d::Identity();
    I_O -= moment_kg_m * p_OCom.transpose();
  }

  SpatialInertia& operator+=(const SpatialInertia& other) {
    mass_kg += other.mass_kg;
    moment_kg_m += other.moment_kg_m;
    I_O += other.I_O;
    return *this;
  }

  Vector6 operator*(const Vector6& velocity) const {
    const Eigen::Vector3d w = velocity.head<3>();
    const Eigen::Vector3d v = velocity.tail<3>();
    return spatial(I_O * w + moment_kg_m.cross(v), mass_kg * v - moment_kg_m.cross(w));
  }
};

}  // namespace koboshi::mechanics
