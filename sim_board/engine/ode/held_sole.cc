#include "sim_board/engine/ode/held_sole.h"

#include <cmath>

#include "sim_board/engine/ode/eigen.h"

namespace koboshi::sim {
namespace {

// CFM of the rigid rows, in m/s per N. Not zero, because the rigid rows of two held feet can be redundant. A
// tangential force of 10 N makes the foot creep by 1e-9 m/s.
constexpr double kSoleForceMixing = 1e-10;
constexpr double kLength_m = 1.0;  // of the distance joints

void set_turn(const OdeJoint& motor, int axis, const Eigen::Vector3d& axis_W, double speed_rad_per_s,
              double force_mixing) {
  constexpr int kInWorld = 0;
  dJointSetAMotorAxis(motor.get(), axis, kInWorld, axis_W.x(), axis_W.y(), axis_W.z());
  dJointSetAMotorParam(motor.get(), axis * dParamGroup + dParamVel, speed_rad_per_s);
  dJointSetAMotorParam(motor.get(), axis * dParamGroup + dParamCFM, force_mixing);
}

}  // namespace

HeldSole::HeldSole(dWorldID world, dBodyID body) : body_(body), feedbacks_(std::make_unique<Feedbacks>()) {
  for (std::size_t i = 0; i < kDirections; ++i) {
    distances_[i].reset(dJointCreateDBall(world, nullptr));
    dJointAttach(distances_[i].get(), body, nullptr);
    dJointSetDBallParam(distances_[i].get(), dParamERP, 1.0);
    dJointSetFeedback(distances_[i].get(), &feedbacks_->distances[i]);
  }
  turns_.reset(dJointCreateAMotor(world, nullptr));
  dJointAttach(turns_.get(), body, nullptr);
  dJointSetAMotorMode(turns_.get(), dAMotorUser);
  dJointSetAMotorNumAxes(turns_.get(), kDirections);
  for (int axis = 0; axis < static_cast<int>(kDirections); ++axis)
    dJointSetAMotorParam(turns_.get(), axis * dParamGroup + dParamFMax, dInfinity);
  dJointSetFeedback(turns_.get(), &feedbacks_->turns);
  points_.reserve(kMaxSolePoints);
  forces_W_.reserve(kMaxSolePoints);
  holding_ = true;
  let_go();
}

void HeldSole::let_go() {
  if (!holding_) return;
  for (const OdeJoint& distance : distances_) dJointDisable(distance.get());
  dJointDisable(turns_.get());
  holding_ = false;
}

void HeldSole::place(std::size_t direction, const Eigen::Vector3d& p_W, const Eigen::Vector3d& axis_W,
                     double speed_m_per_s, double force_mixing, double step_s) {
  const dJointID joint = distances_[direction].get();
  const Eigen::Vector3d far_W = p_W - kLength_m * axis_W;
  dJointSetDBallAnchor1(joint, p_W.x(), p_W.y(), p_W.z());
  dJointSetDBallAnchor2(joint, far_W.x(), far_W.y(), far_W.z());
  dJointSetDBallDistance(joint, kLength_m + speed_m_per_s * step_s);
  dJointSetDBallParam(joint, dParamCFM, force_mixing);
}

void HeldSole::hold(std::span<const SolePoint> points, const Eigen::Vector3d& n_W, double error_reduction,
                    double force_mixing, double step_s) {
  if (!holding_) {
    for (const OdeJoint& distance : distances_) dJointEnable(distance.get());
    dJointEnable(turns_.get());
    holding_ = true;
  }
  points_.assign(points.begin(), points.end());
  p_WCom_W_ = vector_of(dBodyGetPosition(body_));
  restoring_per_s_ = error_reduction / step_s;
  force_mixing_ = force_mixing;

  const double count = static_cast<double>(points_.size());
  p_WMean_W_.setZero();
  double mean_depth_m = 0.0;
  for (const SolePoint& point : points_) {
    p_WMean_W_ += point.p_W / count;
    mean_depth_m += point.depth_m / count;
  }
  // Principal axes in the contact plane.
  const Eigen::Vector3d u_W = n_W.unitOrthogonal();
  const Eigen::Vector3d v_W = n_W.cross(u_W);
  double uu = 0.0, uv = 0.0, vv = 0.0;
  for (const SolePoint& point : points_) {
    const double u = u_W.dot(point.p_W - p_WMean_W_);
    const double v = v_W.dot(point.p_W - p_WMean_W_);
    uu += u * u;
    uv += u * v;
    vv += v * v;
  }
  const double angle_rad = 0.5 * std::atan2(2.0 * uv, uu - vv);
  axes_W_ = {n_W, std::cos(angle_rad) * u_W + std::sin(angle_rad) * v_W, Eigen::Vector3d::Zero()};
  axes_W_[2] = n_W.cross(axes_W_[1]);

  double xx = 0.0, yy = 0.0, x_depth = 0.0, y_depth = 0.0;
  for (const SolePoint& point : points_) {
    const double x = axes_W_[1].dot(point.p_W - p_WMean_W_);
    const double y = axes_W_[2].dot(point.p_W - p_WMean_W_);
    xx += x * x;
    yy += y * y;
    x_depth += x * point.depth_m;
    y_depth += y * point.depth_m;
  }
  // Velocity of the point at (x, y) along the normal: v + y w_x - x w_y.
  place(0, p_WMean_W_, n_W, restoring_per_s_ * mean_depth_m, force_mixing / count, step_s);
  place(1, p_WMean_W_, axes_W_[1], 0.0, kSoleForceMixing, step_s);
  place(2, p_WMean_W_, axes_W_[2], 0.0, kSoleForceMixing, step_s);
  set_turn(turns_, 0, n_W, 0.0, kSoleForceMixing);
  set_turn(turns_, 1, axes_W_[1], restoring_per_s_ * y_depth / yy, force_mixing / yy);
  set_turn(turns_, 2, axes_W_[2], -restoring_per_s_ * x_depth / xx, force_mixing / xx);
}

double HeldSole::held_N(std::size_t direction) const {
  return axes_W_[direction].dot(vector_of(feedbacks_->distances[direction].f1));
}

bool HeldSole::is_possible(double friction) {
  const Eigen::Vector3d v_W = vector_of(dBodyGetLinearVel(body_));
  const Eigen::Vector3d w_W = vector_of(dBodyGetAngularVel(body_));
  const Eigen::Vector3d& n_W = axes_W_[0];
  forces_W_.clear();
  double sum_N = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const SolePoint& point : points_) {
    const double rise_m_per_s = n_W.dot(v_W + w_W.cross(point.p_W - p_WCom_W_));
    const double normal_N = (restoring_per_s_ * point.depth_m - rise_m_per_s) / force_mixing_;
    if (normal_N < 0.0) return false;
    forces_W_.push_back(normal_N * n_W);
    sum_N += normal_N;
    moment += normal_N * point.p_W;
  }
  if (!(sum_N > 0.0)) return false;
  const Eigen::Vector3d p_WPressure_W = moment / sum_N;
  double turned_Nm2 = 0.0;  // sum of normal force times squared distance from the centre of pressure
  for (std::size_t i = 0; i < points_.size(); ++i)
    turned_Nm2 += n_W.dot(forces_W_[i]) * (points_[i].p_W - p_WPressure_W).squaredNorm();
  const Eigen::Vector3d slide_N = held_N(1) * axes_W_[1] + held_N(2) * axes_W_[2];
  const double turn_Nm =
      n_W.dot(vector_of(feedbacks_->turns.t1)) + n_W.dot((p_WMean_W_ - p_WPressure_W).cross(slide_N));
  const double twist_per_m = turned_Nm2 > 0.0 ? turn_Nm / turned_Nm2 : 0.0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3d share = slide_N / sum_N + twist_per_m * n_W.cross(points_[i].p_W - p_WPressure_W);
    const double normal_N = n_W.dot(forces_W_[i]);
    if (normal_N > 0.0 && share.norm() > friction) return false;
    forces_W_[i] += normal_N * share;
  }
  return true;
}

}  // namespace koboshi::sim
