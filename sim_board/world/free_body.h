#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace koboshi::sim_board {

// A loose rigid body beside the robot: a ball that it kicks, a box that it pushes. Uniform density.
struct FreeBodyDescription {
  enum class Shape { kSphere, kBox };

  std::string name;
  Shape shape = Shape::kSphere;
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();  // edges of a box; the first is a sphere's diameter
  double mass_kg = 1.0;
  double friction = 0.5;  // Coulomb's mu; the smaller one of two surfaces applies
  double bounce = 0.5;    // coefficient of restitution, 0..1; the larger one of two surfaces applies
  // A ball's: share of the normal force, at its radius, that resists its rotation; it holds on a slope of up
  // to this tangent. 0.01 to 0.05 on short carpet.
  double rolling_friction = 0.0;
  // Time that the body touches a rigid floor in a bounce without loss. It sets the stiffness of one contact
  // point, m (pi / T)^2. 5 ms is that of a tennis ball, 4 to 6 ms (Cross, "Dynamic properties of tennis
  // balls", Sports Engineering 2, 1999).
  double contact_time_s = 0.005;
  Eigen::Isometry3d X_WF = Eigen::Isometry3d::Identity();  // initial pose; the origin is the centre of mass
  Eigen::Vector3d v_WF_W = Eigen::Vector3d::Zero();        // initial velocity, m/s

  // Moments of inertia about the axes of F, kg m^2.
  Eigen::Vector3d moments_kg_m2() const;
};

struct FreeBodyState {
  Eigen::Isometry3d X_WF = Eigen::Isometry3d::Identity();
  Eigen::Vector3d v_WF_W = Eigen::Vector3d::Zero();  // of the centre of mass, m/s
  Eigen::Vector3d w_WF_W = Eigen::Vector3d::Zero();  // rad/s
};

// Throws std::invalid_argument for a body that no such body is: without mass or size, or with values that are
// not finite.
void check(const std::vector<FreeBodyDescription>& bodies);

}  // namespace koboshi::sim_board
