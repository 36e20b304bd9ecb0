#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "studio/document/drag_body.h"
#include "studio/document/drag_reach.h"
#include "studio/document/motion_robot.h"

namespace koboshi::studio {

// The pose that a drag reaches.
struct DraggedPose {
  std::vector<double> angles_rad = {};  // by joint, within the limits
  // Whether the target is reached. If not, this is the nearest reachable pose (drag_reach.h).
  bool reached = true;
  double missing_m = 0.0;                  // between the grabbed point and its target
  double missing_rad = 0.0;                // of a rotation
  std::vector<std::size_t> at_limit = {};  // joints of the dragged limbs that are at a limit
};

// Inverse kinematics of a drag (simulation/motion_language/parse/body_targets.h). A foot moves its leg; the
// trunk moves over the support: over both feet, which stay where they are relative to each other, or over
// one, while the other leg keeps its angles and goes with the trunk. Feet and trunk keep their orientation
// unless they are rotated. A hand moves its arm so that the grabbed point reaches its target; it is not
// rotated. Equal targets give equal poses, whatever the way of the mouse.
class PoseDrag {
 public:
  // `grabbed_B_m`: a point of the body in axes and from the origin of the trunk B, in the pose `angles_rad`.
  // `support` matters for the trunk only. `robot` must outlive this.
  PoseDrag(const MotionRobot& robot, std::span<const double> angles_rad, DragBody body,
           const Eigen::Vector3d& grabbed_B_m, DragSupport support = DragSupport::kBothFeet);

  // Moves the grabbed point by `displacement_B_m` and rotates the body by the rotation vector
  // `rotation_B_rad` about the grabbed point; both in axes of the trunk as it was when the drag began. A
  // rotation by more than half a turn is out of reach.
  [[nodiscard]] DraggedPose move(const Eigen::Vector3d& displacement_B_m,
                                 const Eigen::Vector3d& rotation_B_rad = Eigen::Vector3d::Zero()) const;

  // Joints that the drag may change, as a mask.
  std::uint32_t joints() const { return joints_; }

 private:
  struct Attempt {
    bool reached = false;
    std::vector<fixed::Angle> angles = {};
  };
  DraggedPose move_within(const Eigen::Vector3d& displacement_B_m, const Eigen::Vector3d& rotation) const;
  Attempt solve(const Eigen::Vector3d& displacement_B_m, const Eigen::Vector3d& rotation_B_rad,
                std::span<const fixed::Angle> from) const;
  bool moves_over_both() const { return body_ == DragBody::kTrunk && support_ == DragSupport::kBothFeet; }
  bool keeps_soles(std::span<const fixed::Angle> angles) const;
  bool is_near(std::span<const fixed::Angle> one, std::span<const fixed::Angle> other) const;
  std::vector<double> angles_of(std::span<const fixed::Angle> angles) const;
  std::vector<double> last_on_line(const Eigen::Vector3d& displacement_B_m,
                                   const Eigen::Vector3d& rotation_B_rad) const;
  DraggedPose result(std::vector<double> angles_rad) const;

  const MotionRobot& robot_;
  DragBody body_;
  DragSupport support_;
  std::size_t side_;              // of the limb that moves
  simulation::NamedModel model_;  // whose hand is the grabbed point
  std::vector<double> start_rad_;
  std::vector<fixed::Angle> start_;
  Eigen::Vector3d grabbed_B_m_;
  Eigen::Isometry3d X_BS_ = Eigen::Isometry3d::Identity();     // the left sole at the start
  Eigen::Isometry3d X_BSole_ = Eigen::Isometry3d::Identity();  // of the dragged foot or the support
  Eigen::Vector3d p_SRight_m_ = Eigen::Vector3d::Zero();       // the right sole in the left one's frame
  Eigen::Vector3d hip_B_m_ = Eigen::Vector3d::Zero();          // centre between the hips
  std::uint32_t joints_ = 0;
  DragReach reach_;
};

}  // namespace koboshi::studio
