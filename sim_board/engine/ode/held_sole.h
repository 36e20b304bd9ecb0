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

// A contact point of a box with the ground.
struct SolePoint {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  double depth_m = 0.0;
};

// A flat face at rest on the ground: replaces the contact of all its points by six unbounded rows. ODE's
// contact joints have three rows per point; the solver must determine one by one that they neither separate
// nor slip, and they are redundant for a sole. Assuming contact and checking it afterwards costs one
// factorisation and no search.
//
// All points have equal springs and dampers, f_i = (ERP depth_i / h - v_i) / CFM along the normal. About the
// principal axes of the points they form three independent rows:
//   rise     CFM / n,
//   tilts    CFM / sum y_i^2, CFM / sum x_i^2.
// The other three rows (sliding in two directions and rotation about the normal) are rigid.
class HeldSole {
 public:
  static constexpr std::size_t kMaxSolePoints = 16;

  // Constrains the body relative to the world; initially nothing is held.
  HeldSole(dWorldID world, dBodyID body);

  // Holds these points in the next solution: three to kMaxSolePoints, not collinear, with a common normal out
  // of the ground. ERP and CFM are those of one point at this step.
  void hold(std::span<const SolePoint> points, const Eigen::Vector3d& n_W, double error_reduction,
            double force_mixing, double step_s);
  void let_go();
  bool holds() const { return holding_; }

  // Returns, after a solution, whether the ground can exert these forces: no point is pulled, and friction at
  // each point is within its cone when force and moment about the centre of pressure are distributed in
  // proportion to the normal forces (for the moment also to the distance). This condition is sufficient;
  // another distribution might be valid where this one is not.
  bool is_possible(double friction);
  // Force on the body at each point in N, as computed by is_possible.
  std::span<const Eigen::Vector3d> forces_W() const { return forces_W_; }

 private:
  static constexpr std::size_t kDirections = 3;  // normal and two tangents

  void place(std::size_t direction, const Eigen::Vector3d& p_W, const Eigen::Vector3d& axis_W,
             double speed_m_per_s, double force_mixing, double step_s);
  double held_N(std::size_t direction) const;

  dBodyID body_;
  // Each joint fixes the distance between a point of the body and a world point 1 m away along an axis: one
  // row.
  std::array<OdeJoint, kDirections> distances_;
  OdeJoint turns_;  // angular motor about the axes of the sole
  struct Feedbacks {
    std::array<dJointFeedback, kDirections> distances{};
    dJointFeedback turns{};
  };
  std::unique_ptr<Feedbacks> feedbacks_;  // must not move, because ODE writes into it
  bool holding_ = false;

  // State of the last hold():
  std::vector<SolePoint> points_;
  std::vector<Eigen::Vector3d> forces_W_;
  std::array<Eigen::Vector3d, kDirections> axes_W_;  // normal first
  Eigen::Vector3d p_WMean_W_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_WCom_W_ = Eigen::Vector3d::Zero();
  double restoring_per_s_ = 0.0;  // ERP / h
  double force_mixing_ = 0.0;
};

}  // namespace koboshi::sim
