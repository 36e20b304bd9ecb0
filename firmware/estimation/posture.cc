#include "firmware/estimation/posture.h"

#include "firmware/robot/kinematics.h"

namespace koboshi::estimation {

robot::Position Posture::centre_of_mass(hal::Side side) const {
  const robot::Pose& X_BThisSole = X_BSole[side];
  return robot::transpose(X_BThisSole.R) * (p_BCom - X_BThisSole.p);
}

Posture posture_at(const robot::RobotModel& model, std::span<const fixed::Angle> angles) {
  if (model.joint_count == 0) return {};
  robot::LinkPoses X_BLinks;
  robot::forward_kinematics(model, angles, X_BLinks);
  return {.X_BSole = {robot::sole_pose(model, hal::Side::kLeft, X_BLinks),
                      robot::sole_pose(model, hal::Side::kRight, X_BLinks)},
          .p_BCom = robot::centre_of_mass(model, X_BLinks)};
}

}  // namespace koboshi::estimation
