#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "sim_board/engine/ode/library.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// A contact point of a foot with the ground.
struct SolePoint {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  double depth_m = 0.0;  // penetration
};

// Contact of one flat foot that stands still on the ground, solved as a whole instead of point by point.
//
// Why: ODE gives each contact point a joint of three bounded rows: the normal force must not pull, and
// friction is limited. The LCP solver searches for the rows at their bounds, which dominates the cost of a
// step. For a flat foot at rest no row is at its bound, and six rows describe the contact of the rigid foot
// completely. This class provides these six rows without bounds: one factorisation, no search.
//
// When: the foot has rested on three or more points for some steps (class Soles decides, and disables the
// contact joints of the points meanwhile). After the solution is_possible() checks the bounds that the rows
// lack. If one is violated, Soles releases the foot and the step is solved again with the contact joints.
//
// Model: all n points have the same spring and damper along the normal, f_i = (ERP depth_i / h - v_i) / CFM
// with step size h. With x and y along the principal axes of the points, about their mean, the sum of these
// forces and their moments decouple into three rows:
//   translation along the normal   CFM / n,
//   rotation about x, about y      CFM / sum y_i^2, CFM / sum x_i^2.
// The other three rows (translation along x and y, rotation about the normal) are rigid: static friction.
class HeldSole {
 public:
  static constexpr std::size_t kMaxSolePoints = 16;

  // Creates the disabled joints between the body of the foot and the world.
  HeldSole(dWorldID world, dBodyID body);

  // Enables the six rows for the next solution. `points` are three to kMaxSolePoints, not collinear; `n_W` is
  // their common normal, out of the ground; ERP and CFM are those of one point at this step size.
  void hold(std::span<const SolePoint> points, const Eigen::Vector3d& n_W, double error_reduction,
            double force_mixing, double step_s);
  // Disables the rows.
  void let_go();
  bool holds() const { return holding_; }

  // Returns, after a solution, whether contact points could exert the forces of the six rows: no point pulls,
  // and friction at each is within Coulomb's limit. Tangential force and moment about the centre of pressure
  // are shared among the points in proportion to their normal forces (the moment also to the distance). The
  // condition is therefore sufficient, not necessary: another distribution might satisfy the limits.
  bool is_possible(double friction);
  // Force on the body at each point in N, as computed by is_possible().
  std::span<const Eigen::Vector3d> forces_W() const { return forces_W_; }

 private:
  static constexpr std::size_t kDirections = 3;  // normal and two tangents

  void place(std::size_t direction, const Eigen::Vector3d& p_W, const Eigen::Vector3d& axis_W,
             double speed_m_per_s, double force_mixing, double step_s);
  double held_N(std::size_t direction) const;

  dBodyID body_;
  // The rows of translation. A joint fixes the distance between the mean of the points and a world point 1 m
  // away along the axis: the cheapest joint of ODE with one linear row.
  std::array<OdeJoint, kDirections> distances_;
  OdeJoint turns_;  // the rows of rotation: an angular motor about the axes
  struct Feedbacks {
    std::array<dJointFeedback, kDirections> distances{};
    dJointFeedback turns{};
  };
  std::unique_ptr<Feedbacks> feedbacks_;  // must not move, because ODE writes into it
  bool holding_ = false;

  // State of the last hold():
  std::vector<SolePoint> points_;
  std::vector<Eigen::Vector3d> forces_W_;
  std::array<Eigen::Vector3d, kDirections> axes_W_;      // normal first
  Eigen::Vector3d p_WMean_W_ = Eigen::Vector3d::Zero();  // of the points
  Eigen::Vector3d p_WCom_W_ = Eigen::Vector3d::Zero();
  double restoring_per_s_ = 0.0;  // ERP / h
  double force_mixing_ = 0.0;
};

}  // namespace koboshi::sim
