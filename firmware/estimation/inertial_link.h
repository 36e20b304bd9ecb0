#pragma once

#include <array>
#include <span>

#include "firmware/robot/model.h"

namespace koboshi::estimation {

// The pose and the speed of the link L that carries the inertial unit, relative to the trunk B, from the
// angles of the joints between them: a unit above the waist while the trunk is the pelvis, or one in the
// head. With the axes a_i of these joints and their speeds q'_i,
//
//   w_WB_B = R_BL w_WL_L - w_BL_B,   w_BL_B = sum_i R_Bi a_i q'_i.
//
// A speed is the change of the angle in one cycle, halved together with the last speed: its delay of 10 ms is
// that of the gyro's filter.
class InertialLink {
 public:
  using Rates = robot::Vector<fixed::AngularRate>;

  // The model must outlive it.
  explicit InertialLink(const robot::RobotModel& model) : model_(model) {}

  // Returns whether it is the trunk itself, which needs no conversion.
  [[nodiscard]] bool is_trunk() const { return model_.imu_link.is_trunk(); }
  // Takes the measured angles of a control cycle, one for each joint. Compiled for size: few robots need it.
  [[gnu::cold]] void update(std::span<const fixed::Angle> angles);

  [[nodiscard]] const robot::Rotation& R_BL() const { return R_BL_; }
  [[nodiscard]] const Rates& w_BL_B() const { return w_BL_B_; }

 private:
  fixed::AngularRate speed(robot::JointIndex joint, fixed::Angle angle);

  const robot::RobotModel& model_;
  robot::Rotation R_BL_;
  Rates w_BL_B_{};
  std::array<fixed::Angle, robot::kMaxJoints> last_{};
  std::array<fixed::AngularRate, robot::kMaxJoints> speeds_{};
  bool started_ = false;
};

}  // namespace koboshi::estimation
