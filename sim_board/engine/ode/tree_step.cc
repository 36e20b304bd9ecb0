#include "sim_board/engine/ode/tree_step.h"

#include <cmath>

#include "sim_board/engine/common/model_constants.h"
#include "sim_board/engine/ode/eigen.h"

namespace koboshi::sim_board {
namespace {

// Integrates the orientation as ODE does, by the quaternion's rate at the new angular velocity:
//   dq/dt = 1/2 (0, w) q, with the scalar part first.
void turn(dBodyID body, const Eigen::Vector3d& w_W, double step_s) {
  const dReal* q = dBodyGetQuaternion(body);
  const Eigen::Vector3d axis(q[1], q[2], q[3]);
  const Eigen::Vector3d half = 0.5 * step_s * w_W;
  const Eigen::Vector3d vector = axis + q[0] * half + half.cross(axis);
  const dQuaternion turned{q[0] - half.dot(axis), vector.x(), vector.y(), vector.z()};
  dBodySetQuaternion(body, turned);  // normalises it
}

std::size_t count_between(std::span<const JointChain> chains) {
  std::size_t count = 0;
  for (const JointChain& chain : chains) count += chain.links_between();
  return count;
}

// One joint for each hinge. Links between the hinges follow the `bodies` of ODE.
std::vector<mechanics::JointSpace::Joint> tree_joints(std::span<const JointChain> chains,
                                                      std::size_t bodies) {
  std::vector<mechanics::JointSpace::Joint> joints;
  for (const JointChain& chain : chains) {
    std::size_t parent = chain.parent_index();
    for (std::size_t i = 0; i < chain.links_between(); ++i, ++bodies) {
      joints.push_back({.parent = parent, .child = bodies});
      parent = bodies;
    }
    joints.push_back({.parent = parent, .child = chain.child_index()});
  }
  return joints;
}

}  // namespace

TreeStep::TreeStep(const RobotDescription& robot, const Bodies& bodies, std::span<const JointChain> chains,
                   std::span<const Coupling> couplings, const Eigen::Vector3d& gravity_W_m_per_s2,
                   double step_s)
    : bodies_(bodies),
      step_s_(step_s),
      couplings_(couplings.begin(), couplings.end()),
      solver_(bodies.all().size() + count_between(chains), tree_joints(chains, bodies.all().size())),
      inertias_(solver_.tree().bodies(), gravity_W_m_per_s2, step_s),
      velocities_(bodies.all().size()) {
  for (std::size_t b = 0; b < velocities_.size(); ++b)
    inertias_.describe(b, robot.links[static_cast<std::size_t>(bodies.link_of(b))]);
  Start next{.joint = 0, .between = bodies.all().size()};
  for (const JointChain& chain : chains) {
    places_.push_back(next);
    for (std::size_t i = 0; i < chain.links_between(); ++i)
      inertias_.describe(next.between + i, chain.link(i));
    next.joint += chain.links_between() + 1;
    next.between += chain.links_between();
  }
}

void TreeStep::begin(std::span<const JointChain> chains) {
  const dBodyID base = bodies_.all().front().get();
  p_WO_W_ = vector_of(dBodyGetPosition(base));
  solver_.tree().fix_root(dBodyIsKinematic(base) != 0);
  for (std::size_t b = 0; b < velocities_.size(); ++b) read_body(b);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    for (std::size_t i = 0; i < chains[c].links_between(); ++i) {
      const LinkDescription& link = chains[c].link(i);
      const BodyState state = chains[c].link_between(i);
      inertias_.set(places_[c].between + i, state.X_WL.linear(), state.X_WL * link.p_LCom_L - p_WO_W_,
                    state.v_WCom_W, state.w_WL_W);
    }
  }
  inertias_.write(solver_.tree());
  for (std::size_t b = 0; b < velocities_.size(); ++b) add_forces(b);
}

void TreeStep::read_body(std::size_t index) {
  const dBodyID body = bodies_.all()[index].get();
  velocities_[index] = {vector_of(dBodyGetLinearVel(body)), vector_of(dBodyGetAngularVel(body))};
  const auto& [v_W, w_W] = velocities_[index];
  inertias_.set(index, rotation_of(dBodyGetRotation(body)), vector_of(dBodyGetPosition(body)) - p_WO_W_, v_W,
                w_W);
}

// Accumulated by pushes.
void TreeStep::add_forces(std::size_t index) {
  const dBodyID body = bodies_.all()[index].get();
  const Eigen::Vector3d force_N = vector_of(dBodyGetForce(body));
  const Eigen::Vector3d torque_Nm = vector_of(dBodyGetTorque(body));
  if (force_N.isZero(0.0) && torque_Nm.isZero(0.0)) return;
  mechanics::Vector6 force = mechanics::spatial_force(vector_of(dBodyGetPosition(body)) - p_WO_W_, force_N);
  force.head<3>() += torque_Nm;
  solver_.tree().body(index).momentum += step_s_ * force;
}

bool TreeStep::solve(std::span<JointChain> chains, Collider& collider, Soles& soles) {
  std::vector<TreeRow>& rows = solver_.rows();
  rows.clear();
  solver_.frictions().clear();
  solver_.terms().clear();
  for (std::size_t c = 0; c < chains.size(); ++c)
    chains[c].write_tree_joint(p_WO_W_, solver_.tree(), places_[c].joint, rows);
  for (const Coupling& coupling : couplings_) add_coupling(coupling, chains);
  soles.add_rows(rows, p_WO_W_);
  for (std::size_t i = 0; i < collider.contacts().size(); ++i) {
    const Contact& contact = collider.contacts()[i];
    if (contact.other_link < 0 && soles.holds(contact.link)) continue;
    collider.add_rows(i, solver_, bodies_, p_WO_W_);
  }
  if (!solver_.solve()) {
    restore_velocities();
    return false;
  }
  write_velocities();
  for (std::size_t c = 0; c < chains.size(); ++c) chains[c].read_tree_torques(solver_, places_[c].joint);
  return true;
}

// The impulse x of the row acts as a torque x on the follower and -multiplier x on the leader: it does no
// work.
void TreeStep::add_coupling(const Coupling& coupling, std::span<JointChain> chains) {
  std::vector<TreeRow>& rows = solver_.rows();
  const JointChain& follower_chain = chains[coupling.follower.chain];
  const JointChain& leader_chain = chains[coupling.leader.chain];
  ServoMotor& follower = chains[coupling.follower.chain].motor(coupling.follower.hinge);
  ServoMotor& leader = chains[coupling.leader.chain].motor(coupling.leader.hinge);
  const double error_rad = follower.state().position_rad -
                           (coupling.multiplier * leader.state().position_rad + coupling.offset_rad);
  TreeRow row{.body = static_cast<int>(follower_chain.child_index()),
              .other_body = static_cast<int>(follower_chain.parent_index())};
  row.jacobian = mechanics::spatial(follower.axis_W(), Eigen::Vector3d::Zero());
  row.other_jacobian = -row.jacobian;
  row.target = -kCouplingErrorReduction / step_s_ * error_rad - follower.drift_rad_per_s() +
               coupling.multiplier * leader.drift_rad_per_s();
  row.softness = kCouplingForceMixing / step_s_;
  const mechanics::Vector6 of_leader =
      -coupling.multiplier * mechanics::spatial(leader.axis_W(), Eigen::Vector3d::Zero());
  solver_.terms().push_back({rows.size(), static_cast<int>(leader_chain.child_index()), of_leader});
  solver_.terms().push_back({rows.size(), static_cast<int>(leader_chain.parent_index()), -of_leader});
  follower.couple(rows.size(), 1.0);
  leader.couple(rows.size(), -coupling.multiplier);
  rows.push_back(row);
}

void TreeStep::write_velocities() {
  for (std::size_t b = 0; b < velocities_.size(); ++b) {
    const dBodyID body = bodies_.all()[b].get();
    const mechanics::Vector6& velocity = solver_.tree().velocity(b);
    const Eigen::Vector3d v_W = mechanics::velocity_at(velocity, vector_of(dBodyGetPosition(body)) - p_WO_W_);
    dBodySetLinearVel(body, v_W.x(), v_W.y(), v_W.z());
    dBodySetAngularVel(body, velocity[0], velocity[1], velocity[2]);
  }
}

void TreeStep::restore_velocities() {
  for (std::size_t b = 0; b < velocities_.size(); ++b) {
    const dBodyID body = bodies_.all()[b].get();
    const auto& [v_W, w_W] = velocities_[b];
    dBodySetLinearVel(body, v_W.x(), v_W.y(), v_W.z());
    dBodySetAngularVel(body, w_W.x(), w_W.y(), w_W.z());
  }
}

void TreeStep::finish(std::span<JointChain> chains) {
  solver_.find_joint_impulses();
  for (std::size_t c = 0; c < chains.size(); ++c)
    chains[c].read_tree_joints(p_WO_W_, solver_, places_[c].joint, places_[c].between);
  for (const OdeBody& owned : bodies_.all()) {
    const dBodyID body = owned.get();
    turn(body, vector_of(dBodyGetAngularVel(body)), step_s_);
    const Eigen::Vector3d p_W =
        vector_of(dBodyGetPosition(body)) + step_s_ * vector_of(dBodyGetLinearVel(body));
    dBodySetPosition(body, p_W.x(), p_W.y(), p_W.z());
    dBodySetForce(body, 0.0, 0.0, 0.0);
    dBodySetTorque(body, 0.0, 0.0, 0.0);
  }
}

void TreeStep::archive(StateArchive& archive) { archive(solver_); }

}  // namespace koboshi::sim_board
