#include "sim_board/engine/ode/servo_joint.h"

#include <cmath>
#include <numbers>

#include "sim_board/engine/ode/eigen.h"
#include "sim_board/world/surface_contact.h"

namespace koboshi::sim {
namespace {

// Faster than this a joint slides, with the friction known from its sign; slower it may stick, and the solver
// decides. Kc h / J of a small servo is 0.03 rad/s: a sliding joint cannot jump across the band. 0.01 to 0.3
// behave alike.
constexpr double kSlidingSpeed_rad_per_s = 0.1;
// Leaves the friction row solvable beside others; creep under 0.03 N m: 3e-12 rad/s.
constexpr double kStickingForceMixing = 1e-10;
// A constant torque without any damping still needs a CFM: 1e-9 N m of error at 1 rad/s.
constexpr double kLeastDamping_Nm_s = 1e-9;
// The stops: a stalled servo of 1.4 N m bends one by 0.14 mrad. Damped far beyond critical, so that nothing
// bounces off; what ran past its limit within a step returns in kd/kp = 4 ms.
constexpr double kStopStiffness_Nm_per_rad = 1e4;
constexpr double kStopDamping_Nm_s_per_rad = 40.0;

constexpr int kDrive = 0;  // numbers of the axes
constexpr int kFriction = 1;
constexpr int kStop = 2;
constexpr int kAxes = 3;

void set(const OdeJoint& motor, int axis, int parameter, double value) {
  dJointSetAMotorParam(motor.get(), axis * dParamGroup + parameter, value);
}

}  // namespace

ServoJoint::ServoJoint(dWorldID world, const JointDescription& joint, dBodyID child, dBodyID parent,
                       double start_rad, double step_s)
    : step_s_(step_s),
      lower_rad_(joint.lower_rad),
      upper_rad_(joint.upper_rad),
      parent_(parent),
      hinge_(dJointCreateHinge(world, nullptr)),
      motor_(dJointCreateAMotor(world, nullptr)),
      feedbacks_(std::make_unique<Feedbacks>()),
      state_{.position_rad = start_rad} {
  dJointAttach(hinge_.get(), child, parent);
  dJointSetHingeAnchor(hinge_.get(), joint.p_MJ.x(), joint.p_MJ.y(), joint.p_MJ.z());
  dJointSetHingeAxis(hinge_.get(), joint.axis_M.x(), joint.axis_M.y(), joint.axis_M.z());
  dJointSetFeedback(hinge_.get(), &feedbacks_->hinge);

  dJointAttach(motor_.get(), child, parent);
  dJointSetAMotorMode(motor_.get(), dAMotorUser);
  dJointSetAMotorNumAxes(motor_.get(), kAxes);
  constexpr int kFixedToParent = 2;
  for (int axis = 0; axis < kAxes; ++axis)
    dJointSetAMotorAxis(motor_.get(), axis, kFixedToParent, joint.axis_M.x(), joint.axis_M.y(),
                        joint.axis_M.z());
  set(motor_, kFriction, dParamVel, 0.0);
  set(motor_, kFriction, dParamCFM, kStickingForceMixing);
  dJointSetFeedback(motor_.get(), &feedbacks_->motor);
  set_stop(joint);
}

void ServoJoint::set_stop(const JointDescription& joint) {
  const Softness stop = softness(kStopStiffness_Nm_per_rad, kStopDamping_Nm_s_per_rad, step_s_);
  set(motor_, kStop, dParamLoStop, joint.lower_rad);
  set(motor_, kStop, dParamHiStop, joint.upper_rad);
  set(motor_, kStop, dParamStopERP, stop.error_reduction);
  set(motor_, kStop, dParamStopCFM, stop.constraint_force_mixing);
}

void ServoJoint::begin_step() {
  dJointSetAMotorAngle(motor_.get(), kStop, state_.position_rad);
  dVector3 axis, anchor;
  dJointGetHingeAxis(hinge_.get(), axis);
  dJointGetHingeAnchor(hinge_.get(), anchor);
  axis_W_ = vector_of(axis);
  p_AnchorParentCom_W_ = vector_of(dBodyGetPosition(parent_)) - vector_of(anchor);

  // A joint that crept goes on creeping, as the first guess.
  if (std::abs(state_.speed_rad_per_s) > kSlidingSpeed_rad_per_s) {
    friction_ = Friction::kSliding;
    direction_ = std::copysign(1.0, state_.speed_rad_per_s);
  } else if (friction_ == Friction::kSliding) {
    friction_ = Friction::kCreeping;
  } else if (friction_ == Friction::kBounded) {
    friction_ = Friction::kLocked;
  }
}

void ServoJoint::guess_friction() {
  // At a stop the friction's part of the torque is not known apart from the stop's.
  const bool at_stop = state_.position_rad <= lower_rad_ || state_.position_rad >= upper_rad_;
  if (at_stop && friction_ != Friction::kSliding) friction_ = Friction::kBounded;
  write_rows();
}

void ServoJoint::bound_friction() {
  if (friction_ != Friction::kSliding) friction_ = Friction::kBounded;
  write_rows();
}

void ServoJoint::write_rows() {
  const double inertial_Nm_s = servo_.rotor_inertia_kg_m2 / step_s_;
  const bool slides = friction_ == Friction::kSliding || friction_ == Friction::kCreeping;
  const bool locked = friction_ == Friction::kLocked && servo_.friction_Nm > 0.0;
  const double a = servo_.drive_Nm + inertial_Nm_s * state_.speed_rad_per_s -
                   (slides ? direction_ * servo_.friction_Nm : 0.0);
  const double b = std::max(servo_.damping_Nm_s + inertial_Nm_s, kLeastDamping_Nm_s);
  const bool driven = !locked && (a != 0.0 || b > kLeastDamping_Nm_s);

  set(motor_, kDrive, dParamVel, a / b);
  set(motor_, kDrive, dParamCFM, 1.0 / b);
  set(motor_, kDrive, dParamFMax, driven ? dInfinity : 0.0);
  set(motor_, kFriction, dParamFMax, locked ? dInfinity : slides ? 0.0 : servo_.friction_Nm);
}

bool ServoJoint::confirm_friction() {
  if (friction_ == Friction::kLocked) {
    // A locked joint does not move, so of the drive only a is left; the rest of its row's torque is friction.
    const double drive_Nm = servo_.drive_Nm + servo_.rotor_inertia_kg_m2 / step_s_ * state_.speed_rad_per_s;
    const double friction_Nm = axis_W_.dot(vector_of(feedbacks_->motor.t1)) - drive_Nm;
    if (servo_.friction_Nm == 0.0 || std::abs(friction_Nm) <= servo_.friction_Nm) return true;
    friction_ = Friction::kCreeping;
    direction_ = -std::copysign(1.0, friction_Nm);
    return false;
  }
  if (friction_ == Friction::kCreeping && direction_ * dJointGetHingeAngleRate(hinge_.get()) < 0.0) {
    friction_ = Friction::kLocked;
    return false;
  }
  return true;
}

void ServoJoint::read_state() {
  // ODE's angle wraps at +-pi.
  const double turn = dJointGetHingeAngle(hinge_.get()) - state_.position_rad;
  state_.position_rad += std::remainder(turn, 2.0 * std::numbers::pi);
  state_.speed_rad_per_s = dJointGetHingeAngleRate(hinge_.get());
  state_.servo_Nm = axis_W_.dot(vector_of(feedbacks_->motor.t1));

  // The second body is the parent; ODE's torques are about its centre of mass, at the pose before the step.
  wrench_.force_N = vector_of(feedbacks_->hinge.f2) + vector_of(feedbacks_->motor.f2);
  wrench_.torque_Nm = vector_of(feedbacks_->hinge.t2) + vector_of(feedbacks_->motor.t2) +
                      p_AnchorParentCom_W_.cross(wrench_.force_N);
}

}  // namespace koboshi::sim
