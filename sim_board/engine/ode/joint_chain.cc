#include "sim_board/engine/ode/joint_chain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim_board/engine/ode/eigen.h"

namespace koboshi::sim_board {
namespace {

// Share of a joint's position error that one step removes: ODE's default ERP. The tree's joints drift by
// round-off and by the finite rotations of a step, a few micrometres.
constexpr double kJointErrorReduction = 0.2;

// Five degrees short of a quarter turn.
constexpr double kMaxMiddle_rad = std::numbers::pi / 2.0 * 85.0 / 90.0;

template <typename Described>
std::array<const Described*, JointChain::kMaxHinges> described(const std::vector<Described>& all,
                                                               const HingeChain& chain,
                                                               const auto& index_of) {
  std::array<const Described*, JointChain::kMaxHinges> found{};
  for (std::size_t i = 0; i < chain.joints.size(); ++i)
    found[i] = &all[static_cast<std::size_t>(index_of(chain.joints[i]))];
  return found;
}

OdeJoint make_constraint(dWorldID world, std::size_t hinges, dBodyID child, dBodyID parent,
                         const Eigen::Vector3d& p, const Eigen::Matrix3d& R_MF) {
  const Eigen::Vector3d first = R_MF.col(0);
  const Eigen::Vector3d second = R_MF.col(1);
  if (hinges == 1) {
    OdeJoint joint(dJointCreateHinge(world, nullptr));
    dJointAttach(joint.get(), child, parent);
    dJointSetHingeAnchor(joint.get(), p.x(), p.y(), p.z());
    dJointSetHingeAxis(joint.get(), first.x(), first.y(), first.z());
    return joint;
  }
  if (hinges == 2) {
    OdeJoint joint(dJointCreateUniversal(world, nullptr));
    dJointAttach(joint.get(), child, parent);
    dJointSetUniversalAnchor(joint.get(), p.x(), p.y(), p.z());
    dJointSetUniversalAxis1(joint.get(), second.x(), second.y(), second.z());  // fixed in the child
    dJointSetUniversalAxis2(joint.get(), first.x(), first.y(), first.z());
    return joint;
  }
  OdeJoint joint(dJointCreateBall(world, nullptr));
  dJointAttach(joint.get(), child, parent);
  dJointSetBallAnchor(joint.get(), p.x(), p.y(), p.z());
  return joint;
}

}  // namespace

JointChain::JointChain(dWorldID world, const RobotDescription& robot, const HingeChain& chain,
                       const Bodies& bodies, std::span<const double> starts_rad, double step_s)
    : chain_(chain),
      joints_(described(robot.joints, chain, [](int joint) { return joint; })),
      links_(described(robot.links, chain,
                       [&](int joint) { return robot.joints[static_cast<std::size_t>(joint)].child; })),
      parent_(bodies.of(joint(0).parent)),
      child_(bodies.of(joint(size() - 1).child)),
      parent_index_(bodies.index_of(joint(0).parent)),
      child_index_(bodies.index_of(joint(size() - 1).child)),
      step_s_(step_s),
      R_ParentM_(rotation_of(dBodyGetRotation(parent_)).transpose()),
      R_ChildM_(rotation_of(dBodyGetRotation(child_)).transpose()),
      p_ParentAnchor_(R_ParentM_ * (joint(0).p_MJ - vector_of(dBodyGetPosition(parent_)))),
      p_ChildAnchor_(R_ChildM_ * (joint(0).p_MJ - vector_of(dBodyGetPosition(child_)))),
      feedback_(std::make_unique<dJointFeedback>()) {
  R_MF_.col(0) = joint(0).axis_M;
  R_MF_.col(1) = size() > 1 ? joint(1).axis_M : joint(0).axis_M.unitOrthogonal();
  R_MF_.col(2) = R_MF_.col(0).cross(R_MF_.col(1));
  if (size() > 2) third_sign_ = std::copysign(1.0, R_MF_.col(2).dot(joint(2).axis_M));

  for (std::size_t i = 0; i < links_between(); ++i)
    p_ACom_M_[i] = link(i).X_ML * link(i).p_LCom_L - joint(0).p_MJ;
  constraint_ = make_constraint(world, size(), child_, parent_, joint(0).p_MJ, R_MF_);
  dJointSetFeedback(constraint_.get(), feedback_.get());
  motors_.reserve(size());
  for (std::size_t i = 0; i < size(); ++i) {
    JointDescription description = joint(i);
    if (size() == 3 && i == 1) {
      description.lower_rad = std::max(description.lower_rad, -kMaxMiddle_rad);
      description.upper_rad = std::min(description.upper_rad, kMaxMiddle_rad);
    }
    motors_.emplace_back(world, description, child_, parent_,
                         starts_rad[static_cast<std::size_t>(chain_.joints[i])], step_s);
  }
}

Eigen::Vector3d JointChain::relative_rate_W() const {
  return vector_of(dBodyGetAngularVel(child_)) - vector_of(dBodyGetAngularVel(parent_));
}

void JointChain::place() {
  place_bodies();
  place_hinges();
}

void JointChain::place_bodies() {
  const Eigen::Matrix3d R_WP = rotation_of(dBodyGetRotation(parent_));
  placement_.R_WParent = R_WP * R_ParentM_;
  placement_.R_WChild = rotation_of(dBodyGetRotation(child_)) * R_ChildM_;
  placement_.p_ParentAnchor_W = R_WP * p_ParentAnchor_;
  placement_.p_WAnchor_W = vector_of(dBodyGetPosition(parent_)) + placement_.p_ParentAnchor_W;
}

// At the hinges' positions of the last step.
void JointChain::place_hinges() {
  Vectors& axes_W = placement_.axes_W;
  Eigen::Matrix3d R_WM = placement_.R_WParent;
  axes_W[0] = R_WM * joint(0).axis_M;
  if (size() == 2) axes_W[1] = placement_.R_WChild * joint(1).axis_M;
  if (size() == 3) axes_W[2] = placement_.R_WChild * joint(2).axis_M;
  for (std::size_t i = 0; i < links_between(); ++i) {
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(motors_[i].state().position_rad, joint(i).axis_M).toRotationMatrix();
    if (i == 0 && size() == 3) axes_W[1] = R_WM * (R * joint(1).axis_M);
    R_WM = R_WM * R;
    LinkPose& pose = placement_.between[i];
    pose.R_WL = R_WM * link(i).X_ML.linear();
    pose.p_ACom_W = R_WM * p_ACom_M_[i];
  }
  placement_.duals_W = duals(axes_W);
}

// With rotations alpha, beta, gamma about the columns of F, the child's orientation relative to the parent is
//   Rx(alpha) Ry(beta) Rz(gamma) = [  cb cg           -cb sg           sb
//                                     sa sb cg + ca sg  ca cg - sa sb sg  -sa cb
//                                     sa sg - ca sb cg  ca sb sg + sa cg   ca cb ].
std::array<double, JointChain::kMaxHinges> JointChain::positions_rad() const {
  const Eigen::Matrix3d R = (placement_.R_WParent * R_MF_).transpose() * (placement_.R_WChild * R_MF_);
  if (size() == 1) return {std::atan2(R(2, 1), R(1, 1))};
  if (size() == 2) return {std::atan2(R(2, 1), R(1, 1)), std::atan2(R(0, 2), R(0, 0))};
  return {std::atan2(-R(1, 2), R(2, 2)), std::atan2(R(0, 2), std::hypot(R(0, 0), R(0, 1))),
          third_sign_ * std::atan2(-R(0, 1), R(0, 0))};
}

JointChain::Vectors JointChain::duals(const Vectors& axes_W) const {
  if (size() < 3) return axes_W;  // perpendicular unit vectors
  const Eigen::Vector3d first = axes_W[1].cross(axes_W[2]);
  const double volume = axes_W[0].dot(first);
  return {first / volume, axes_W[1], axes_W[0].cross(axes_W[1]) / volume};
}

// Returns sum of da_i/dt speed_i, the part of dw/dt without changes of the speeds. With w_P of the parent,
//   da_1/dt = w_P x a_1,  da_2/dt = (w_P + a_1 speed_1) x a_2,  and so on.
// A single hinge has no such component along its axis.
Eigen::Vector3d JointChain::turning_of_axes_W(const Vectors& axes_W) const {
  Eigen::Vector3d turning_W = Eigen::Vector3d::Zero();
  if (size() == 1) return turning_W;
  Eigen::Vector3d w_W = vector_of(dBodyGetAngularVel(parent_));
  for (std::size_t i = 0; i < size(); ++i) {
    const Eigen::Vector3d along_W = axes_W[i] * motors_[i].state().speed_rad_per_s;
    turning_W += w_W.cross(along_W);
    w_W += along_W;
  }
  return turning_W;
}

JointChain::Velocity JointChain::velocity_of_link(std::size_t i) const {
  Eigen::Vector3d w_W = vector_of(dBodyGetAngularVel(parent_));
  const Eigen::Vector3d v_WAnchor_W =
      vector_of(dBodyGetLinearVel(parent_)) + w_W.cross(placement_.p_ParentAnchor_W);
  for (std::size_t k = 0; k <= i; ++k) w_W += placement_.axes_W[k] * motors_[k].state().speed_rad_per_s;
  return {v_WAnchor_W + w_W.cross(placement_.between[i].p_ACom_W), w_W};
}

BodyState JointChain::link_between(std::size_t i) const {
  const LinkPose& pose = placement_.between[i];
  BodyState state{.v_WCom_W = between_[i].v_WCom_W, .w_WL_W = between_[i].w_W};
  state.X_WL.linear() = pose.R_WL;
  state.X_WL.translation() = placement_.p_WAnchor_W + pose.p_ACom_W - pose.R_WL * link(i).p_LCom_L;
  return state;
}

void JointChain::begin_step() {
  const Vectors& b = placement_.duals_W;
  const Eigen::Vector3d turning_W = turning_of_axes_W(placement_.axes_W);
  for (std::size_t i = 0; i < size(); ++i) motors_[i].begin_step(b[i], -step_s_ * b[i].dot(turning_W));
  p_AnchorParentCom_W_ = vector_of(dBodyGetPosition(parent_)) - placement_.p_WAnchor_W;
}

void JointChain::bound_friction() {
  for (ServoMotor& motor : motors_) motor.bound_friction();
}

void JointChain::write_ode_rows() {
  for (ServoMotor& motor : motors_) motor.write_ode_rows();
}

// Returns the angular velocity of the child relative to the parent that corrects the axes: aligns the images
// of a hinge's axis in both bodies, makes those of a universal joint perpendicular.
Eigen::Vector3d JointChain::correcting_rate_W() const {
  const Vectors& axes_W = placement_.axes_W;
  if (size() == 1)
    return kJointErrorReduction / step_s_ * (placement_.R_WChild * joint(0).axis_M).cross(axes_W[0]);
  if (size() == 2)
    return kJointErrorReduction / step_s_ * axes_W[0].dot(axes_W[1]) *
           axes_W[0].cross(axes_W[1]).normalized();
  return Eigen::Vector3d::Zero();
}

void JointChain::write_tree_joint(const Eigen::Vector3d& p_WO_W, mechanics::JointSpace& tree,
                                  std::size_t index, std::vector<TreeRow>& rows) {
  const Eigen::Vector3d& p_WAnchor = placement_.p_WAnchor_W;
  const Eigen::Vector3d p_OAnchor_W = p_WAnchor - p_WO_W;
  const Eigen::Vector3d p_WChildAnchor =
      vector_of(dBodyGetPosition(child_)) + rotation_of(dBodyGetRotation(child_)) * p_ChildAnchor_;
  tree.slip(index + size() - 1) = mechanics::spatial_velocity(
      correcting_rate_W(), p_OAnchor_W, kJointErrorReduction / step_s_ * (p_WAnchor - p_WChildAnchor));
  for (std::size_t i = 0; i < size(); ++i) {
    const std::size_t dof = tree.first_dof(index + i);
    mechanics::JointSpace::Axis& axis = tree.axis(dof);
    axis.motion = mechanics::spatial_velocity(placement_.axes_W[i], p_OAnchor_W, Eigen::Vector3d::Zero());
    motors_[i].write_tree_axis(axis);
    motors_[i].add_rows(rows, static_cast<int>(child_index_), static_cast<int>(parent_index_), dof);
  }
}

void JointChain::read_tree_torques(const TreeSolver& solver, std::size_t index) {
  const std::size_t first = solver.tree().first_dof(index);
  for (std::size_t i = 0; i < size(); ++i) motors_[i].read_tree(solver, solver.tree().speed(first + i));
}

bool JointChain::confirm_friction() {
  const Eigen::Vector3d w_W = relative_rate_W();
  bool confirmed = true;
  for (ServoMotor& motor : motors_) {
    if (motor.friction_is_right(w_W)) continue;
    confirmed = false;
    motor.correct_friction();
  }
  return confirmed;
}

void JointChain::finish_step() {
  place_bodies();
  const std::array<double, kMaxHinges> positions = positions_rad();
  for (std::size_t i = 0; i < size(); ++i) motors_[i].set_position(positions[i]);
  place_hinges();
  const Eigen::Vector3d w_W = relative_rate_W();
  for (std::size_t i = 0; i < size(); ++i) motors_[i].set_speed(placement_.duals_W[i].dot(w_W));
}

// Wrench on the parent's side. What the tree's joint does not transmit are the torques of the bounded rows,
// which act on parent and child.
void JointChain::read_tree_joints(const Eigen::Vector3d& p_WO_W, const TreeSolver& solver, std::size_t index,
                                  std::size_t between) {
  const Eigen::Vector3d p_OAnchor_W = placement_.p_WAnchor_W - p_WO_W;
  Eigen::Vector3d rows_Nm = Eigen::Vector3d::Zero();
  for (const ServoMotor& motor : motors_) rows_Nm += motor.on_parent_Nm() + motor.tree_torque_W_Nm();
  for (std::size_t i = 0; i < size(); ++i) {
    const mechanics::Vector6 wrench =
        solver.tree().joint_impulse(index + i) / step_s_;  // on the child, about the origin
    const Eigen::Vector3d force_N = wrench.tail<3>();
    wrenches_[i] = {-force_N, rows_Nm - wrench.head<3>() + p_OAnchor_W.cross(force_N)};
  }
  for (std::size_t i = 0; i < links_between(); ++i) {
    const mechanics::Vector6& velocity = solver.tree().velocity(between + i);
    const Eigen::Vector3d& p_ACom_W = placement_.between[i].p_ACom_W;
    between_[i] = {mechanics::velocity_at(velocity, p_OAnchor_W + p_ACom_W), velocity.head<3>()};
  }
}

void JointChain::read_ode_joint() {
  Wrench wrench{.force_N = vector_of(feedback_->f2), .torque_Nm = vector_of(feedback_->t2)};
  for (const ServoMotor& motor : motors_) wrench.torque_Nm += motor.on_parent_Nm();
  wrench.torque_Nm += p_AnchorParentCom_W_.cross(wrench.force_N);
  wrenches_.fill(wrench);
  for (std::size_t i = 0; i < links_between(); ++i) between_[i] = velocity_of_link(i);
}

void JointChain::archive(StateArchive& archive) { archive(motors_, wrenches_, between_); }

}  // namespace koboshi::sim_board
