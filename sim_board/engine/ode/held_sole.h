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

// A point at which a box presses on the ground.
struct SolePoint {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  double depth_m = 0.0;
};

// A plane face that stands on the ground: the contact of all its points as six rows without bounds. ODE's own
// contact joints have three rows a point, of which the solver must find out one by one that they neither lift
// nor slip; the rows of a sole are redundant besides. Taken for granted and checked afterwards, it costs a
// factorisation and no search.
//
// The points' springs and dampers are alike, each f_i = (ERP depth_i / h - v_i) / CFM along the normal. About
// the principal axes of the points they are three independent ones:
//   rise     CFM / n,
//   tilts    CFM / sum y_i^2, CFM / sum x_i^2.
// The rest, sliding in two directions and turning about the normal, is zero.
class HeldSole {
 public:
  static constexpr std::size_t kMostPoints = 16;

  // Of the body against the world; nothing is held yet.
  HeldSole(dWorldID world, dBodyID body);

  // Holds the points for the next solution. They are three to kMostPoints, not in a line, and share the
  // normal, which points out of the ground. ERP and CFM are those of one point at this step.
  void hold(std::span<const SolePoint> points, const Eigen::Vector3d& n_W, double error_reduction,
            double force_mixing, double step_s);
  void let_go();
  bool holds() const { return holding_; }

  // After a solution: whether the ground can do this. No point is pulled, and each point's friction is within
  // its cone, when force and moment about the centre of pressure are spread over the points in proportion to
  // their normal forces (the moment's part also to their distance). That is enough; another spread might do
  // where this one does not.
  bool is_possible(double friction);
  // What the body feels at each point, N, as is_possible found it.
  std::span<const Eigen::Vector3d> forces_W() const { return forces_W_; }

 private:
  static constexpr std::size_t kDirections = 3;  // normal, and two along the ground

  void place(std::size_t direction, const Eigen::Vector3d& p_W, const Eigen::Vector3d& axis_W,
             double speed_m_per_s, double force_mixing, double step_s);
  double held_N(std::size_t direction) const;

  dBodyID body_;
  // The distance of a point of the body from one of the world 1 m away along an axis: one row.
  std::array<OdeJoint, kDirections> distances_;
  OdeJoint turns_;  // an angular motor about the axes of the sole
  struct Feedbacks {
    std::array<dJointFeedback, kDirections> distances{};
    dJointFeedback turns{};
  };
  std::unique_ptr<Feedbacks> feedbacks_;  // ODE writes into it, so it never moves
  bool holding_ = false;

  // As held:
  std::vector<SolePoint> points_;
  std::vector<Eigen::Vector3d> forces_W_;
  std::array<Eigen::Vector3d, kDirections> axes_W_;  // normal first
  Eigen::Vector3d p_WMean_W_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_WCom_W_ = Eigen::Vector3d::Zero();
  double restoring_per_s_ = 0.0;  // ERP / h
  double force_mixing_ = 0.0;
};

}  // namespace koboshi::sim
