#include "sim_board/engine/ode/servo_motor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim_board/engine/common/model_constants.h"
#include "sim_board/engine/ode/eigen.h"
#include "sim_board/world/surface_contact.h"

namespace koboshi::sim_board {
namespace {

// After two wrong guesses within this time the solver decides, for the same duration. Otherwise a joint with
// a flickering encoder, or two joints that hold each other through the feet, would be guessed wrong
// repeatedly.
constexpr double kDoubt_s = 0.03;
// A constant torque without damping still needs a CFM: the error is 1e-9 N m at 1 rad/s.
constexpr double kMinDamping_Nm_s = 1e-9;

constexpr int kDrive = 0;  // indices of the motor's axes
constexpr int kFriction = 1;
constexpr int kInWorld = 0;  // body to which an axis is fixed

void set(const OdeJoint& motor, int axis, int parameter, double value) {
  dJointSetAMotorParam(motor.get(), axis * dParamGroup + parameter, value);
}

OdeJoint make_motor(dWorldID world, dBodyID child, dBodyID parent, int axes, dJointFeedback& feedback) {
  OdeJoint motor(dJointCreateAMotor(world, nullptr));
  dJointAttach(motor.get(), child, parent);
  dJointSetAMotorMode(motor.get(), dAMotorUser);
  dJointSetAMotorNumAxes(motor.get(), axes);
  dJointSetFeedback(motor.get(), &feedback);
  return motor;
}

}  // namespace

ServoMotor::ServoMotor(dWorldID world, const JointDescription& joint, dBodyID child, dBodyID parent,
                       double start_rad, double step_s)
    : step_s_(step_s),
      lower_rad_(joint.lower_rad),
      upper_rad_(joint.upper_rad),
      feedbacks_(std::make_unique<Feedbacks>()),
      state_{.position_rad = start_rad} {
  motor_ = make_motor(world, child, parent, 2, feedbacks_->servo);
  stop_ = make_motor(world, child, parent, 1, feedbacks_->stop);
  stop_softness_ = softness(kStopStiffness_Nm_per_rad, kStopDamping_Nm_s_per_rad, step_s_);
  set(stop_, 0, dParamStopERP, stop_softness_.error_reduction);
}

void ServoMotor::begin_step(const Eigen::Vector3d& b_W, double drift_rad_per_s) {
  b_W_ = b_W;
  scale_ = b_W.norm();
  drift_rad_per_s_ = drift_rad_per_s;
  *feedbacks_ = {};  // ODE does not update the feedback of a motor without rows

  if (doubted_steps_ > 0) --doubted_steps_;
  if (std::abs(state_.speed_rad_per_s) > kSlidingSpeed_rad_per_s) {
    friction_ = Friction::kSliding;
    direction_ = std::copysign(1.0, state_.speed_rad_per_s);
  } else if (friction_ == Friction::kSliding) {
    friction_ = Friction::kCreeping;  // a creeping joint stays so as the first guess
  } else if (friction_ == Friction::kBounded && doubted_steps_ == 0) {
    friction_ = Friction::kLocked;
  }
}

void ServoMotor::bound_friction() {
  if (friction_ != Friction::kSliding) friction_ = Friction::kBounded;
}

// The damping of a locked joint is the inverse of the friction row's softness.
ServoMotor::Torque ServoMotor::tree_torque() const {
  return is_locked() ? Torque{0.0, 1.0 / kStickingForceMixing} : unbounded_torque();
}

ServoMotor::Torque ServoMotor::unbounded_torque() const {
  const double inertial_Nm_s = servo_.rotor_inertia_kg_m2 / step_s_;
  return {servo_.drive_Nm + inertial_Nm_s * state_.speed_rad_per_s -
              (slides() ? direction_ * servo_.friction_Nm : 0.0),
          std::max(servo_.damping_Nm_s + inertial_Nm_s, kMinDamping_Nm_s)};
}

void ServoMotor::write_ode_rows() {
  for (int axis : {kDrive, kFriction})
    dJointSetAMotorAxis(motor_.get(), axis, kInWorld, b_W_.x(), b_W_.y(), b_W_.z());
  const auto [a, b] = unbounded_torque();
  const bool locked = is_locked();
  const double target_rad_per_s = a / b - drift_rad_per_s_;
  const bool driven = !locked && (a != 0.0 || b > kMinDamping_Nm_s);

  set(motor_, kDrive, dParamVel, target_rad_per_s / scale_);
  set(motor_, kDrive, dParamCFM, 1.0 / (b * scale_ * scale_));
  set(motor_, kDrive, dParamFMax, driven ? dInfinity : 0.0);
  set(motor_, kFriction, dParamVel, -drift_rad_per_s_ / scale_);
  set(motor_, kFriction, dParamCFM, kStickingForceMixing / (scale_ * scale_));
  set(motor_, kFriction, dParamFMax, locked ? dInfinity : slides() ? 0.0 : servo_.friction_Nm * scale_);
  write_ode_stop();
}

void ServoMotor::write_ode_stop() {
  dJointSetAMotorAxis(stop_.get(), 0, kInWorld, b_W_.x(), b_W_.y(), b_W_.z());
  set(stop_, 0, dParamLoStop, lower_rad_ / scale_);
  set(stop_, 0, dParamHiStop, upper_rad_ / scale_);
  set(stop_, 0, dParamStopCFM, stop_softness_.constraint_force_mixing / (scale_ * scale_));
  dJointSetAMotorAngle(stop_.get(), 0, state_.position_rad / scale_);
}

void ServoMotor::write_tree_axis(mechanics::JointSpace::Axis& axis) const {
  const Torque torque = tree_torque();
  axis.damping = step_s_ * torque.damping_Nm_s;
  axis.drive = step_s_ * (torque.at_rest_Nm - torque.damping_Nm_s * drift_rad_per_s_);
}

void ServoMotor::add_rows(std::vector<TreeRow>& rows, int child, int parent, std::size_t dof) {
  friction_row_ = stop_row_ = coupling_row_ = kNoRow;
  const bool has_friction = friction_ == Friction::kBounded && servo_.friction_Nm > 0.0;
  const bool below = state_.position_rad <= lower_rad_;
  const bool at_stop = below || state_.position_rad >= upper_rad_;
  if (!has_friction && !at_stop) return;
  TreeRow row{.body = child, .other_body = parent};
  row.jacobian = mechanics::spatial(b_W_, Eigen::Vector3d::Zero());
  row.other_jacobian = -row.jacobian;
  if (has_friction) {
    row.target = -drift_rad_per_s_;
    row.softness = kStickingForceMixing / step_s_;
    row.upper = step_s_ * servo_.friction_Nm;
    row.lower = -row.upper;
    row.id = 2 * dof;
    friction_row_ = static_cast<int>(rows.size());
    rows.push_back(row);
  }
  if (!at_stop) return;
  const double error_rad = state_.position_rad - (below ? lower_rad_ : upper_rad_);
  row.target = -stop_softness_.error_reduction / step_s_ * error_rad;
  row.softness = stop_softness_.constraint_force_mixing / step_s_;
  row.lower = below ? 0.0 : -dInfinity;
  row.upper = below ? dInfinity : 0.0;
  row.id = 2 * dof + 1;
  stop_row_ = static_cast<int>(rows.size());
  rows.push_back(row);
}

void ServoMotor::read_tree(const TreeSolver& solver, double speed_rad_per_s) {
  const auto torque_Nm = [&](int row) {
    return row == kNoRow ? 0.0 : solver.impulse(static_cast<std::size_t>(row)) / step_s_;
  };
  const Torque torque = tree_torque();
  tree_Nm_ = torque.at_rest_Nm - torque.damping_Nm_s * (speed_rad_per_s + drift_rad_per_s_);
  const auto write = [&](double hinge_Nm, dJointFeedback& feedback) {
    copy_vector(hinge_Nm * b_W_, feedback.t1);
    copy_vector(-hinge_Nm * b_W_, feedback.t2);
  };
  write(tree_Nm_ + torque_Nm(friction_row_), feedbacks_->servo);
  const double stop_Nm = torque_Nm(stop_row_);
  const bool is_coupled = coupling_row_ != kNoRow;
  write(is_coupled ? stop_Nm + coupling_share_ * torque_Nm(coupling_row_) : stop_Nm, feedbacks_->stop);
}

double ServoMotor::servo_Nm() const { return b_W_.dot(vector_of(feedbacks_->servo.t1)) / (scale_ * scale_); }

// Returns the share of dry friction in the servo's torque for a solution with this final speed.
double ServoMotor::friction_Nm(double speed_rad_per_s) const {
  const double inertial_Nm_s = servo_.rotor_inertia_kg_m2 / step_s_;
  return servo_Nm() - servo_.drive_Nm - inertial_Nm_s * state_.speed_rad_per_s +
         (servo_.damping_Nm_s + inertial_Nm_s) * speed_rad_per_s;
}

bool ServoMotor::friction_is_right(const Eigen::Vector3d& w_W) const {
  if (friction_ == Friction::kLocked)
    return servo_.friction_Nm == 0.0 || std::abs(friction_Nm(0.0)) <= servo_.friction_Nm;
  return friction_ != Friction::kCreeping || direction_ * (b_W_.dot(w_W) + drift_rad_per_s_) >= 0.0;
}

void ServoMotor::correct_friction() {
  if (doubted_steps_ > 0) {
    friction_ = Friction::kBounded;
  } else if (friction_ == Friction::kLocked) {
    friction_ = Friction::kCreeping;
    direction_ = -std::copysign(1.0, friction_Nm(0.0));
  } else {
    friction_ = Friction::kLocked;
  }
  doubted_steps_ = static_cast<int>(std::ceil(kDoubt_s / step_s_));
}

// Less than half a turn is its own remainder.
void ServoMotor::set_position(double position_rad) {
  const double way_rad = position_rad - state_.position_rad;
  state_.position_rad +=
      std::abs(way_rad) < std::numbers::pi ? way_rad : std::remainder(way_rad, 2.0 * std::numbers::pi);
  state_.servo_Nm = servo_Nm();
}

Eigen::Vector3d ServoMotor::on_parent_Nm() const {  // the second body
  return vector_of(feedbacks_->servo.t2) + vector_of(feedbacks_->stop.t2);
}

void ServoMotor::archive(StateArchive& archive) {
  archive(*feedbacks_, servo_, state_, friction_, doubted_steps_, direction_, b_W_, drift_rad_per_s_, scale_);
}

}  // namespace koboshi::sim_board
