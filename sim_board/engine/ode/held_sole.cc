#include "sim_board/engine/ode/held_sole.h"

#include <cmath>

#include "sim_board/engine/ode/eigen.h"
#include "sim_board/engine/ode/library.h"

namespace koboshi::sim_board {
namespace {

// The sole's rows in their order, beginning with first_row_.
enum Row : std::size_t { kRise, kSlideX, kSlideY, kTurnNormal, kTurnX, kTurnY };

}  // namespace

HeldSole::HeldSole(dBodyID ode_body, int body) : ode_body_(ode_body), body_(body) {
  points_.reserve(kMaxSolePoints);
  forces_W_.reserve(kMaxSolePoints);
}

void HeldSole::hold(std::span<const SolePoint> points, const Eigen::Vector3d& n_W, double error_reduction,
                    double force_mixing, double step_s) {
  holding_ = true;
  points_.assign(points.begin(), points.end());
  restoring_per_s_ = error_reduction / step_s;
  force_mixing_ = force_mixing;
  step_s_ = step_s;
  find_axes(n_W);
  find_springs();
}

// Along the principal axes the sum of x y is zero. Their angle to any axes u, v in the contact plane is half
// of atan2(2 sum uv, sum uu - sum vv).
void HeldSole::find_axes(const Eigen::Vector3d& n_W) {
  p_WMean_W_.setZero();
  for (const SolePoint& point : points_) p_WMean_W_ += point.p_W / static_cast<double>(points_.size());
  const Eigen::Vector3d u_W = n_W.unitOrthogonal();
  const Eigen::Vector3d v_W = n_W.cross(u_W);
  double uu = 0.0;
  double uv = 0.0;
  double vv = 0.0;
  for (const SolePoint& point : points_) {
    const double u = u_W.dot(point.p_W - p_WMean_W_);
    const double v = v_W.dot(point.p_W - p_WMean_W_);
    uu += u * u;
    uv += u * v;
    vv += v * v;
  }
  const double angle_rad = 0.5 * std::atan2(2.0 * uv, uu - vv);
  axes_W_[0] = n_W;
  axes_W_[1] = std::cos(angle_rad) * u_W + std::sin(angle_rad) * v_W;
  axes_W_[2] = n_W.cross(axes_W_[1]);
}

void HeldSole::find_springs() {
  depth_m_ = xx_m2_ = yy_m2_ = x_depth_m2_ = y_depth_m2_ = 0.0;
  for (const SolePoint& point : points_) {
    const double x = axes_W_[1].dot(point.p_W - p_WMean_W_);
    const double y = axes_W_[2].dot(point.p_W - p_WMean_W_);
    depth_m_ += point.depth_m;
    xx_m2_ += x * x;
    yy_m2_ += y * y;
    x_depth_m2_ += x * point.depth_m;
    y_depth_m2_ += y * point.depth_m;
  }
}

void HeldSole::add_rows(std::vector<TreeRow>& rows, const Eigen::Vector3d& p_WO_W) {
  first_row_ = rows.size();
  const auto add = [&](const mechanics::Vector6& jacobian, double speed, double force_mixing) {
    rows.push_back(
        {.body = body_, .jacobian = jacobian, .target = speed, .softness = force_mixing / step_s_});
  };
  const auto slide = [&](const Eigen::Vector3d& axis_W) {
    return mechanics::spatial_force(p_WMean_W_ - p_WO_W, axis_W);
  };
  const auto turn = [](const Eigen::Vector3d& axis_W) {
    return mechanics::spatial(axis_W, Eigen::Vector3d::Zero());
  };
  const double count = static_cast<double>(points_.size());
  // In the order of Row. The target of a spring's row is the speed at which its force would be zero.
  add(slide(axes_W_[0]), restoring_per_s_ * depth_m_ / count, force_mixing_ / count);
  add(slide(axes_W_[1]), 0.0, kStickingForceMixing);
  add(slide(axes_W_[2]), 0.0, kStickingForceMixing);
  add(turn(axes_W_[0]), 0.0, kStickingForceMixing);
  add(turn(axes_W_[1]), restoring_per_s_ * y_depth_m2_ / yy_m2_, force_mixing_ / yy_m2_);
  add(turn(axes_W_[2]), -restoring_per_s_ * x_depth_m2_ / xx_m2_, force_mixing_ / xx_m2_);
}

bool HeldSole::is_possible(const TreeSolver& solver, double friction) {
  const Eigen::Vector3d v_W = vector_of(dBodyGetLinearVel(ode_body_));
  const Eigen::Vector3d w_W = vector_of(dBodyGetAngularVel(ode_body_));
  const Eigen::Vector3d p_WCom_W = vector_of(dBodyGetPosition(ode_body_));
  const Eigen::Vector3d& n_W = axes_W_[0];

  // Normal force at each point, from the sole's speed there.
  forces_W_.clear();
  double sum_N = 0.0;
  Eigen::Vector3d moment_Nm = Eigen::Vector3d::Zero();
  for (const SolePoint& point : points_) {
    const double rise_m_per_s = n_W.dot(v_W + w_W.cross(point.p_W - p_WCom_W));
    const double normal_N = (restoring_per_s_ * point.depth_m - rise_m_per_s) / force_mixing_;
    if (normal_N < 0.0) return false;
    forces_W_.push_back(normal_N * n_W);
    sum_N += normal_N;
    moment_Nm += normal_N * point.p_W;
  }
  if (!(sum_N > 0.0)) return false;
  const Eigen::Vector3d p_WPressure_W = moment_Nm / sum_N;

  // Friction exerts a tangential force and a moment about the normal through the centre of pressure. Point i
  // has the share f_i (slide / sum f + twist n x r_i), with r_i from the centre of pressure. The moments add
  // up to twist sum f_i r_i^2, since sum f_i r_i = 0.
  const auto row_N = [&](Row row) { return solver.impulse(first_row_ + row) / step_s_; };
  const Eigen::Vector3d slide_N = row_N(kSlideX) * axes_W_[1] + row_N(kSlideY) * axes_W_[2];
  const double turn_Nm = row_N(kTurnNormal) + n_W.dot((p_WMean_W_ - p_WPressure_W).cross(slide_N));
  double polar_Nm2 = 0.0;  // sum f_i r_i^2
  for (std::size_t i = 0; i < points_.size(); ++i)
    polar_Nm2 += n_W.dot(forces_W_[i]) * (points_[i].p_W - p_WPressure_W).squaredNorm();
  const double twist_per_m = polar_Nm2 > 0.0 ? turn_Nm / polar_Nm2 : 0.0;

  for (std::size_t i = 0; i < points_.size(); ++i) {
    // Tangential over normal force, limited by Coulomb's law.
    const Eigen::Vector3d ratio = slide_N / sum_N + twist_per_m * n_W.cross(points_[i].p_W - p_WPressure_W);
    const double normal_N = n_W.dot(forces_W_[i]);
    if (normal_N > 0.0 && ratio.norm() > friction) return false;
    forces_W_[i] += normal_N * ratio;
  }
  return true;
}

}  // namespace koboshi::sim_board
