#include "mechanics/joint_space.h"

#include <algorithm>
#include <cmath>

#include "mechanics/lanes.h"
#include "mechanics/vector_clones.h"

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
  std::vector<int> before;  // by dof: the next dof towards the root
  for (std::size_t i = 0; i < kRootDofs; ++i) {
    axes_[i].motion = Vector6::Unit(static_cast<Eigen::Index>(i));
    before.push_back(static_cast<int>(i) - 1);
  }
  last_dof_[0] = static_cast<int>(kRootDofs) - 1;
  for (const Joint& joint : joints_) {
    first_dofs_.push_back(axes_.size());
    int last = last_dof_[joint.parent];
    for (std::size_t i = 0; i < joint.axes; ++i) {
      before.push_back(last);
      last = static_cast<int>(axes_.size());
      axes_.emplace_back();
      moved_.push_back(joint.child);
    }
    last_dof_[joint.child] = last;
  }
  make_paths(before);
  stride_ = (dofs() + 2 * kBlock - 1) / kBlock * kBlock;
  L_.resize(dofs() * stride_);
  diagonal_inverse_.resize(dofs());
  speeds_.resize(dofs());
}

void JointSpace::make_paths(std::span<const int> before) {
  paths_.resize(dofs() * dofs());
  for (std::size_t i = 0; i < dofs(); ++i) {
    const std::size_t depth = before[i] == kNone ? 0 : depths_[dof_index(before[i])] + 1;
    if (depth > 0) std::copy_n(path_to(dof_index(before[i])), depth, &paths_[i * dofs()]);
    paths_[i * dofs() + depth] = i;
    depths_.push_back(depth);
  }
}

std::span<const std::size_t> JointSpace::path(std::size_t body) const {
  const std::size_t last = dof_index(last_dof_[body]);
  return {path_to(last), depths_[last] + 1};
}

// What blocks of a row contain beyond its end is zero.
void JointSpace::fill_matrix() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) inertias_[b] = bodies_[b].inertia;
  for (std::size_t j = joints_.size(); j-- > 0;) inertias_[joints_[j].parent] += inertias_[joints_[j].child];
  for (std::size_t i = first_free_; i < dofs(); ++i) {
    const Vector6 momentum = inertias_[moved_[i]] * axes_[i].motion;
    const std::size_t depth = depths_[i];
    const std::size_t* const path = path_to(i);
    double* const factor = row(i);
    for (std::size_t q = first_free_; q <= depth; ++q) factor[q] = axes_[path[q]].motion.dot(momentum);
    factor[depth] += axes_[i].damping;
    std::fill_n(factor + depth + 1, kBlock - 1, 0.0);
  }
}

// row(dof)[q] for the dof path[p] -= factor[p] factor[q], for all q up to p.
KOBOSHI_VECTOR_CLONES bool JointSpace::factorise_rows() {
  const std::size_t first = first_free_;
  for (std::size_t k = dofs(); k-- > first;) {
    double* const factor = row(k);
    const std::size_t depth = depths_[k];
    const std::size_t* const path = path_to(k);
    if (!(factor[depth] > 0.0)) return false;
    factor[depth] = std::sqrt(factor[depth]);
    const double inverse = 1.0 / factor[depth];
    diagonal_inverse_[k] = inverse;
    for (std::size_t p = first; p < depth; ++p) factor[p] *= inverse;
    for (std::size_t p = first; p < depth; ++p) {
      double* const other = row(path[p]);
      const double scale = factor[p];
      for (std::size_t q = first; q <= p; q += kBlock) four_at(other + q) -= scale * four_at(factor + q);
    }
  }
  return true;
}

bool JointSpace::factorise() {
  fill_matrix();
  return factorise_rows();
}

void JointSpace::solve_transposed(std::span<double> x) const {
  for (std::size_t i = dofs(); i-- > first_free_;) {
    if (x[i] == 0.0) continue;
    x[i] *= diagonal_inverse_[i];
    const double* const factor = row(i);
    const std::size_t* const path = path_to(i);
    for (std::size_t q = first_free_; q < depths_[i]; ++q) x[path[q]] -= factor[q] * x[i];
  }
}

void JointSpace::solve_lower(std::span<double> x) const {
  for (std::size_t i = first_free_; i < dofs(); ++i) {
    const double* const factor = row(i);
    const std::size_t* const path = path_to(i);
    double sum = x[i];
    for (std::size_t q = depths_[i]; q-- > first_free_;) sum -= factor[q] * x[path[q]];
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

// The products are summed in the order of Eigen's dot().
KOBOSHI_VECTOR_CLONES void JointSpace::add_to_jacobian(std::size_t body, std::span<const Lanes, 6> impulses,
                                                       std::span<Lanes> J) const {
  const std::span<const std::size_t> dofs = path(body);
  for (std::size_t place = first_free_; place < dofs.size(); ++place) {
    const double* const motion = axes_[dofs[place]].motion.data();
    J[dofs[place]].all +=
        (motion[0] * impulses[0].all + (motion[2] * impulses[2].all + motion[4] * impulses[4].all)) +
        (motion[1] * impulses[1].all + (motion[3] * impulses[3].all + motion[5] * impulses[5].all));
  }
}

KOBOSHI_VECTOR_CLONES void JointSpace::reduce(std::span<const std::size_t> support,
                                              std::span<Lanes> J) const {
  Lanes* const x = J.data();
  for (std::size_t place = support.size(); place-- > 0;) {
    const std::size_t i = support[place];
    if (i < first_free_) break;
    const Four own = x[i].all * diagonal_inverse_[i];
    x[i].all = own;
    const double* const factor = row(i);
    const std::size_t* const path = path_to(i);
    const std::size_t depth = depths_[i];
    for (std::size_t q = first_free_; q < depth; ++q) x[path[q]].all -= factor[q] * own;
  }
}

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
