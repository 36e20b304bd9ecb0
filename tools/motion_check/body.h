#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/inverse_dynamics.h"
#include "sim_board/description/description.h"
#include "tools/motion_check/support.h"

namespace koboshi::tools {

// The robot's mechanics for the check of motions: a tree of rigid links on one or two soles that do not slip,
// on level ground, in double precision. Vectors are in axes of the trunk B, from its origin, unless a name
// says otherwise.

// The state of the standing robot at an instant.
struct Stance {
  Rest rest;                                        // on the soles' corners, as in Body::corners
  Eigen::Vector2d com_m = Eigen::Vector2d::Zero();  // projected to the ground, in GroundAxes from B's origin
  Eigen::Vector2d zmp_m = Eigen::Vector2d::Zero();  // in the same axes
  double com_height_m = 0.0;                        // above the ground
  std::array<double, 2> load_share{};               // share of the ground force on each foot, by hal::Side
  std::vector<double> torques_Nm;                   // of the servo on each joint, friction excluded
};

class Body {
 public:
  // The robot needs both ankle sensors: they say which links are feet.
  explicit Body(const sim_board::RobotDescription& robot);

  std::size_t joint_count() const { return dynamics_.tree().free_hinges(); }
  // Computes the poses of all links in B, by index of RobotDescription::links.
  void place(std::span<const double> angles_rad, std::vector<Eigen::Isometry3d>& X_BLs) const {
    dynamics_.tree().poses(Eigen::Isometry3d::Identity(), angles_rad, X_BLs);
  }

  // Solves the inverse dynamics of the robot with these joint angles, speeds in rad/s and accelerations in
  // rad/s^2, whose support foot is at rest (mechanics::InverseDynamics), and the ZMP as the point of the
  // ground about which the horizontal moment of the ground force is zero (Vukobratovic and Borovac 2004).
  //
  // On two feet the torques are statically indeterminate. The force is divided so that the feet's own centres
  // of pressure are equally far from their middles; the moment about the vertical is left out.
  void solve(std::span<const double> angles_rad, std::span<const double> speeds,
             std::span<const double> accelerations, Stance& stance);
  // The same without motion.
  void solve_at_rest(std::span<const double> angles_rad, Stance& stance);

  // The hull of the soles' corners that carry, in the axes of stance.com_m: those on the ground, and those
  // that a roll of at most kNearRoll_rad about its edge brings to the ground. Beyond an edge that such a
  // corner guards the robot does not fall; it shifts its weight.
  std::vector<Eigen::Vector2d> support_polygon(const Stance& stance) const;
  // Those of the last solved stance.
  const std::array<Eigen::Vector3d, 8>& corners_B() const { return corners_B_; }
  const std::vector<Eigen::Isometry3d>& X_BLs() const { return dynamics_.X_BLs(); }
  // The foot that carries more.
  static std::size_t support_side(const Stance& stance) {
    return stance.load_share[1] > stance.load_share[0] ? 1 : 0;
  }
  double mass_kg() const { return dynamics_.tree().mass_kg(); }
  // Height of the centre of mass above the soles at joint angles zero.
  double com_height_m() const { return com_height_m_; }
  std::size_t foot_link(std::size_t side) const { return feet_[side].link; }

  // The height by which the servos yield: corners this close to the ground carry. By hand: twice the
  // deflection of a leg of this robot that takes up the weight.
  static constexpr double kTouching_m = 0.0015;
  // By hand: the roll in which a robot of this size takes up no speed that its soles do not absorb.
  static constexpr double kNearRoll_rad = 0.1;

 private:
  struct Foot {
    std::size_t link;
    std::array<Eigen::Vector3d, 4> corners_L;
    Eigen::Vector3d normal_L;
  };

  void find_support(Stance& stance);
  Eigen::Vector3d initial_up() const;
  // Divides the force of the ground among the feet.
  void divide_load(const mechanics::Vector6& total, Stance& stance);

  mechanics::InverseDynamics dynamics_;
  std::vector<double> rotor_inertias_kg_m2_;  // by joint
  std::vector<double> at_rest_;               // zeros, by joint
  std::array<Foot, 2> feet_;
  double com_height_m_ = 0.0;
  std::array<Eigen::Vector3d, 8> corners_B_;  // of the stance being solved
};

}  // namespace koboshi::tools
