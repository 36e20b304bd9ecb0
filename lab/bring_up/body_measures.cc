#include "lab/bring_up/body_measures.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "sim_board/description/hinge_tree.h"
#include "sim_board/world/foot.h"
#include "sim_board/world/gravity.h"

namespace koboshi::lab {
namespace {

const sim_board::JointDescription& joint_of(const sim_board::RobotDescription& robot,
                                            const std::string& role) {
  const auto joint = robot.find_joint(role);
  if (!joint)
    throw InputError(robot.file, robot.line, "no joint " + role,
                     "legs with hip roll and pitch, knee, ankle pitch and ankle roll to walk");
  return robot.joints[static_cast<std::size_t>(*joint)];
}

double stiffness_Nm_per_rad(const sim_board::ServoDescription& servo) {
  return servo.torque_constant_Nm_per_A / servo.resistance_ohm * servo.supply_V /
         servo.full_voltage_error_rad;
}

double weakest_Nm_per_rad(const sim_board::RobotDescription& robot,
                          std::initializer_list<const char*> roles) {
  double weakest = std::numeric_limits<double>::infinity();
  for (const char* role : roles)
    weakest = std::min(weakest, stiffness_Nm_per_rad(joint_of(robot, role).servo));
  return weakest;
}

double mean_z(const sim_board::RobotDescription& robot, const char* role) {
  return 0.5 * (joint_of(robot, std::string("left_") + role).p_MJ.z() +
                joint_of(robot, std::string("right_") + role).p_MJ.z());
}

}  // namespace

BodyMeasures measure(const sim_board::RobotDescription& robot) {
  const auto feet = sim_board::feet_of(robot);
  if (!feet[0] || !feet[1])
    throw InputError(robot.file, robot.line, "no soles below two ankles", "two legs with feet to walk");
  const mechanics::HingeTree tree = sim_board::hinge_tree(robot);
  const std::vector<double> zero(robot.joints.size(), 0.0);
  const auto X_WLs = tree.poses(Eigen::Isometry3d::Identity(), zero);
  const Eigen::Isometry3d left = X_WLs[static_cast<std::size_t>(feet[0]->link)] * feet[0]->X_LSole;
  const Eigen::Isometry3d right = X_WLs[static_cast<std::size_t>(feet[1]->link)] * feet[1]->X_LSole;
  // Anchors are in the model's frame, in which the base stands at its pose.
  const Eigen::Isometry3d X_MW = tree.links()[0].X_ML;
  BodyMeasures body;
  double front_m = -1.0;
  double back_m = 1.0;
  double inner_m = 1.0;
  double other_inner_m = -1.0;
  for (const Eigen::Vector3d& corner_L : feet[0]->corners_L) {
    const Eigen::Vector3d corner_S = feet[0]->X_LSole.inverse() * corner_L;
    front_m = std::max(front_m, corner_S.x());
    back_m = std::min(back_m, corner_S.x());
    inner_m = std::min(inner_m, corner_S.y());
  }
  for (const Eigen::Vector3d& corner_L : feet[1]->corners_L)
    other_inner_m = std::max(other_inner_m, (feet[1]->X_LSole.inverse() * corner_L).y());
  const double sole_z_m = 0.5 * ((X_MW * left).translation().z() + (X_MW * right).translation().z());
  body.leg_m = mean_z(robot, "hip_pitch") - sole_z_m;
  body.limb_m = mean_z(robot, "hip_pitch") - mean_z(robot, "ankle_pitch");
  body.com_m = (X_MW * tree.centre_of_mass(X_WLs)).z() - sole_z_m;
  body.stance_m = left.translation().y() - right.translation().y();
  body.sole_width_m = other_inner_m - inner_m;
  body.sole_middle_m = 0.5 * (front_m + back_m);
  body.weight_N = robot.total_mass_kg() * sim_board::kGravity_m_per_s2;
  body.pitch_stiffness_Nm_per_rad =
      weakest_Nm_per_rad(robot, {"left_hip_pitch", "left_knee", "left_ankle_pitch"});
  body.roll_stiffness_Nm_per_rad = weakest_Nm_per_rad(robot, {"left_hip_roll", "left_ankle_roll"});
  body.supply_V = robot.battery ? robot.battery->open_circuit_V : robot.joints.front().servo.supply_V;
  if (body.leg_m < 0.02 || body.limb_m < 0.01 || body.com_m < 0.02)
    throw InputError(robot.file, robot.line,
                     "hips or a centre of mass that are not above the soles at joint angles zero",
                     "legs that hang down");
  return body;
}

}  // namespace koboshi::lab
