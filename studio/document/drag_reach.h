#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mechanics/bounded_least_squares.h"
#include "mechanics/hinge_tree.h"
#include "studio/document/drag_body.h"
#include "studio/document/motion_robot.h"

namespace koboshi::studio {

// The reach of a drag: the pose within the joint limits that is nearest to a target out of reach.
//
// The grabbed point of a hand comes as near to its target as it can. A foot or the trunk that is moved keeps
// its orientation, and its grabbed point comes as near as it then can; one that is rotated keeps the grabbed
// point, and turns as far as it then can. While the trunk moves over both feet, the soles stay where they are
// relative to each other.
class DragReach {
 public:
  struct Dragged {
    DragBody body = DragBody::kTrunk;
    DragSupport support = DragSupport::kBothFeet;
  };
  // As PoseDrag; `joints` is the mask of the joints that may move. `robot` must outlive this.
  DragReach(const MotionRobot& robot, std::span<const double> angles_rad, const Dragged& dragged,
            const Eigen::Vector3d& grabbed_B_m, std::uint32_t joints);

  // The local minima to which two or more poses lead; the nearest of them. Empty if none keeps what has to be
  // kept. `from` is within the limits and keeps it.
  [[nodiscard]] std::vector<double> nearest(const Eigen::Vector3d& displacement_B_m,
                                            const Eigen::Vector3d& rotation_B_rad,
                                            std::span<const double> from) const;
  // The remaining distance of the grabbed point, or angle of a rotation; the other one is 0.
  struct Missing {
    double m = 0.0;
    double rad = 0.0;
  };
  [[nodiscard]] Missing missing(const Eigen::Vector3d& displacement_B_m,
                                const Eigen::Vector3d& rotation_B_rad,
                                std::span<const double> angles_rad) const;

 private:
  using Links = std::vector<Eigen::Isometry3d>;

  bool rotates(const Eigen::Vector3d& displacement_B_m, const Eigen::Vector3d& rotation_B_rad) const;
  Eigen::VectorXd variables(std::span<const double> angles_rad) const;
  std::vector<double> with_variables(const Eigen::VectorXd& q) const;
  Eigen::Isometry3d moved_body(const Links& links) const;
  Eigen::VectorXd soles_error_m(const Links& links) const;
  mechanics::Residuals residuals(const Eigen::Vector3d& displacement_B_m,
                                 const Eigen::Vector3d& rotation_B_rad,
                                 std::span<const double> angles_rad) const;

  const MotionRobot& robot_;
  Dragged dragged_;
  mechanics::HingeTree tree_;
  std::vector<double> start_rad_;
  std::vector<std::size_t> joints_;
  mechanics::VariableBounds bounds_;
  std::size_t link_ = 0;               // the dragged one
  std::array<std::size_t, 2> feet_{};  // links; the support of the trunk, and the other one
  Eigen::Vector3d grabbed_B_m_;
  Eigen::Isometry3d X_BBody_;  // at the start, as X_BSupport_
  Eigen::Isometry3d X_BSupport_;
  Eigen::Isometry3d X_SupportOther_;  // of the feet
};

}  // namespace koboshi::studio
