#include "mechanics/inverse_dynamics.h"

#include <utility>

namespace koboshi::mechanics {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Rate of change of a motion vector that moves with a body (Featherstone, eq. 2.31).
Vector6 cross_motion(const Vector6& velocity, const Vector6& motion) {
  const Vector3d w = velocity.head<3>();
  return spatial(w.cross(motion.head<3>()),
                 w.cross(motion.tail<3>()) + velocity.tail<3>().cross(motion.head<3>()));
}

// Rate of change of a force vector that moves with a body (Featherstone, eq. 2.32).
Vector6 cross_force(const Vector6& velocity, const Vector6& force) {
  const Vector3d w = velocity.head<3>();
  return spatial(w.cross(force.head<3>()) + velocity.tail<3>().cross(force.tail<3>()),
                 w.cross(force.tail<3>()));
}

}  // namespace

InverseDynamics::InverseDynamics(HingeTree tree)
    : tree_(std::move(tree)),
      X_BLs_(tree_.links().size(), Eigen::Isometry3d::Identity()),
      motions_(tree_.hinges().size()),
      inertias_(tree_.links().size()),
      velocities_(tree_.links().size()),
      accelerations_(tree_.links().size()),
      forces_(tree_.links().size()) {}

void InverseDynamics::place(std::span<const double> positions_rad) {
  tree_.poses(Eigen::Isometry3d::Identity(), positions_rad, X_BLs_);
  com_B_ = tree_.centre_of_mass(X_BLs_);
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    const Hinge& hinge = tree_.hinges()[i];
    const Eigen::Isometry3d X_BM = X_BLs_[hinge.child] * tree_.links()[hinge.child].X_ML.inverse();
    motions_[i] = spatial_velocity(X_BM.linear() * hinge.axis_M, X_BM * hinge.p_MJ, Vector3d::Zero());
  }
  for (std::size_t l = 0; l < inertias_.size(); ++l) {
    const Link& link = tree_.links()[l];
    const Matrix3d R = X_BLs_[l].linear();
    inertias_[l] = SpatialInertia(link.mass_kg, X_BLs_[l] * link.p_LCom_L, R * link.I_LCom_L * R.transpose());
  }
}

double InverseDynamics::rate(std::size_t hinge, std::span<const double> rates) const {
  const auto [free, multiplier] = tree_.free_hinge(hinge);
  return multiplier * rates[free];
}

void InverseDynamics::add_velocities(std::span<const double> speeds_rad_per_s, const Vector6& root) {
  velocities_[0] = root;
  for (const std::size_t i : tree_.hinges_from_root()) {
    const Hinge& hinge = tree_.hinges()[i];
    velocities_[hinge.child] = velocities_[hinge.parent] + rate(i, speeds_rad_per_s) * motions_[i];
  }
}

Vector6 InverseDynamics::find_forces(std::span<const double> speeds_rad_per_s,
                                     std::span<const double> accelerations_rad_per_s2, std::size_t at_rest,
                                     const Vector3d& gravity_B_m_per_s2) {
  add_velocities(speeds_rad_per_s, Vector6::Zero());
  add_velocities(speeds_rad_per_s, -velocities_[at_rest]);
  accelerations_[0].setZero();
  for (const std::size_t i : tree_.hinges_from_root()) {
    const Hinge& hinge = tree_.hinges()[i];
    accelerations_[hinge.child] =
        accelerations_[hinge.parent] + rate(i, accelerations_rad_per_s2) * motions_[i] +
        rate(i, speeds_rad_per_s) * cross_motion(velocities_[hinge.parent], motions_[i]);
  }
  // The link at rest accelerates upwards instead of gravity.
  const Vector6 offset = -accelerations_[at_rest] - spatial(Vector3d::Zero(), gravity_B_m_per_s2);
  Vector6 sum = Vector6::Zero();
  for (std::size_t l = 0; l < forces_.size(); ++l) {
    forces_[l] = inertias_[l] * (accelerations_[l] + offset) +
                 cross_force(velocities_[l], inertias_[l] * velocities_[l]);
    sum += forces_[l];
  }
  return sum;
}

void InverseDynamics::find_torques(std::span<double> torques_Nm) {
  const std::span<const std::size_t> order = tree_.hinges_from_root();
  coupled_Nm_.assign(tree_.couplings().size(), 0.0);
  for (std::size_t place = order.size(); place-- > 0;) {
    const std::size_t i = order[place];
    const Hinge& hinge = tree_.hinges()[i];
    const double torque_Nm = motions_[i].dot(forces_[hinge.child]);
    if (i < tree_.free_hinges()) {
      torques_Nm[i] = torque_Nm;
    } else {
      coupled_Nm_[i - tree_.free_hinges()] = torque_Nm;
    }
    forces_[hinge.parent] += forces_[hinge.child];
  }
  for (std::size_t i = 0; i < coupled_Nm_.size(); ++i) {
    const Coupling& coupling = tree_.couplings()[i];
    torques_Nm[coupling.leader] += coupling.multiplier * coupled_Nm_[i];
  }
}

}  // namespace koboshi::mechanics
