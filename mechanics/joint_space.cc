#include "mechanics/joint_space.h"

#include <algorithm>
#include <cmath>

namespace koboshi::mechanics {
namespace {

std::size_t dof_index(int dof) { return static_cast<std::size_t>(dof); }

}  // namespace

JointSpace::JointSpace(std::size_t bodies, std::span<const Joint> joints)
    : joints_(joints.begin(), joints.end()),
      bodies_(bodies),
      axes_(kRootDofs),
      slips_(joints.size(), Vector6::Zero()),
      last_dof_(bodies, kNone),
      moved_(kRootDofs, 0),
      inertias_(bodies),
      velocities_(bodies, Vector6::Zero()),
      flows_(bodies, Vector6::Zero()) {
  for (std::size_t i = 0; i < kRootDofs; ++i) {
    axes_[i].motion = Vector6::Unit(static_cast<Eigen::Index>(i));
    before_.push_back(static_cast<int>(i) - 1);
  }
  last_dof_[0] = static_cast<int>(kRootDofs) - 1;
  for (const Joint& joint : joints_) {
    first_dofs_.push_back(axes_.size());
    int before = last_dof_[joint.parent];
    for (std::size_t i = 0; i < joint.axes; ++i) {
      before_.push_back(before);
      before = static_cast<int>(axes_.size());
      axes_.emplace_back();
      moved_.push_back(joint.child);
    }
    last_dof_[joint.child] = before;
  }
  L_.resize(dofs() * dofs());
  diagonal_inverse_.resize(dofs());
  speeds_.resize(dofs());
}

void JointSpace::fill_matrix() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) inertias_[b] = bodies_[b].inertia;
  for (std::size_t j = joints_.size(); j-- > 0;) inertias_[joints_[j].parent] += inertias_[joints_[j].child];
  for (std::size_t i = first_free_; i < dofs(); ++i) {
    const Vector6 momentum = inertias_[moved_[i]] * axes_[i].motion;
    for (int j = static_cast<int>(i); is_free(j); j = before_[dof_index(j)])
      row(i)[j] = axes_[dof_index(j)].motion.dot(momentum);
    row(i)[i] += axes_[i].damping;
  }
}

bool JointSpace::factorise() {
  fill_matrix();
  for (std::size_t k = dofs(); k-- > first_free_;) {
    double* const factor = row(k);
    if (!(factor[k] > 0.0)) return false;
    factor[k] = std::sqrt(factor[k]);
    diagonal_inverse_[k] = 1.0 / factor[k];
    for (int i = before_[k]; is_free(i); i = before_[dof_index(i)]) factor[i] *= diagonal_inverse_[k];
    for (int i = before_[k]; is_free(i); i = before_[dof_index(i)]) {
      double* const other = row(dof_index(i));
      for (int j = i; is_free(j); j = before_[dof_index(j)]) other[j] -= factor[i] * factor[j];
    }
  }
  return true;
}

void JointSpace::solve_transposed(std::span<double> x) const {
  for (std::size_t i = dofs(); i-- > first_free_;) {
    if (x[i] == 0.0) continue;  // dofs on other branches than the row's bodies
    x[i] *= diagonal_inverse_[i];
    const double* const factor = row(i);
    for (int j = before_[i]; is_free(j); j = before_[dof_index(j)]) x[dof_index(j)] -= factor[j] * x[i];
  }
}

void JointSpace::solve_lower(std::span<double> x) const {
  for (std::size_t i = first_free_; i < dofs(); ++i) {
    const double* const factor = row(i);
    double sum = x[i];
    for (int j = before_[i]; is_free(j); j = before_[dof_index(j)]) sum -= factor[j] * x[dof_index(j)];
    x[i] = sum * diagonal_inverse_[i];
  }
}

void JointSpace::solve() {
  std::vector<Vector6>& imposed = velocities_;
  imposed[0].setZero();
  for (std::size_t j = 0; j < joints_.size(); ++j)
    imposed[joints_[j].child] = imposed[joints_[j].parent] + slips_[j];
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    flows_[b] = bodies_[b].momentum - bodies_[b].inertia * imposed[b];
  for (std::size_t j = joints_.size(); j-- > 0;) flows_[joints_[j].parent] += flows_[joints_[j].child];
  std::ranges::fill(speeds_, 0.0);
  for (std::size_t i = first_free_; i < dofs(); ++i)
    speeds_[i] = axes_[i].motion.dot(flows_[moved_[i]]) + axes_[i].drive;
  solve_transposed(speeds_);
  solve_lower(speeds_);
  update_velocities();
}

void JointSpace::add_to_jacobian(std::size_t body, const Vector6& impulse, std::span<double> J) const {
  for (int i = last_dof_[body]; is_free(i); i = before_[dof_index(i)])
    J[dof_index(i)] += axes_[dof_index(i)].motion.dot(impulse);
}

void JointSpace::reduce(std::span<double> J) const { solve_transposed(J); }

void JointSpace::apply(std::span<double> reduced_sum) {
  solve_lower(reduced_sum);
  for (std::size_t i = first_free_; i < dofs(); ++i) speeds_[i] += reduced_sum[i];
  update_velocities();
}

void JointSpace::update_velocities() {
  velocities_[0] = Vector6::Map(speeds_.data());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Vector6 velocity = velocities_[joints_[j].parent] + slips_[j];
    for (std::size_t i = first_dofs_[j]; i < first_dofs_[j] + joints_[j].axes; ++i)
      velocity += axes_[i].motion * speeds_[i];
    velocities_[joints_[j].child] = velocity;
  }
}

void JointSpace::find_joint_impulses(std::span<const Vector6> row_impulses) {
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    flows_[b] = bodies_[b].inertia * velocities_[b] - bodies_[b].momentum - row_impulses[b];
  for (std::size_t j = joints_.size(); j-- > 0;) flows_[joints_[j].parent] += flows_[joints_[j].child];
}

}  // namespace koboshi::mechanics
