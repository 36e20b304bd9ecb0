#include "simulation/gait/walking_pose.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "sim_board/description/hinge_tree.h"
#include "sim_board/world/gravity.h"

namespace koboshi::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using hal::Side;
// The centre of mass shifts almost as much as the trunk, so each iteration removes most of the error; five
// leave micrometres.
constexpr int kRounds = 5;
// A foot without hip yaw turns by the product of the trunk's pitch and the hip's roll, some tenths of a
// degree in a straight walk. By hand, 2026-11-27: 2 degrees.
constexpr double kMaxMissingHeading_rad = 0.035;

robot::Pose fixed_pose(const Isometry3d& X) {
  robot::Pose pose;
  for (int row = 0; row < 3; ++row) {
    const auto ratio = [&](int column) { return fixed::from_double<fixed::Ratio>(X.linear()(row, column)); };
    pose.R.rows[static_cast<std::size_t>(row)] = {ratio(0), ratio(1), ratio(2)};
  }
  const auto length = [&](int axis) { return fixed::from_double<fixed::Length>(X.translation()[axis]); };
  pose.p = {length(0), length(1), length(2)};
  return pose;
}

// Returns the servo's torque per radian of position error.
double stiffness_Nm_per_rad(const sim_board::ServoDescription& servo) {
  const double stall_Nm = servo.torque_constant_Nm_per_A * servo.supply_V / servo.resistance_ohm;
  return stall_Nm / servo.full_voltage_error_rad;
}

}  // namespace

WalkingPose::WalkingPose(const Gait& gait, const sim_board::RobotDescription& robot, const NamedModel& model)
    : gait_(gait),
      robot_(robot),
      model_(model),
      tree_(sim_board::hinge_tree(robot)),
      upper_body_rad_(robot.joints.size(), 0.0) {
  for (const Side side : {Side::kLeft, Side::kRight}) {
    // load_named_model has checked that the legs have this geometry.
    if (!robot::make_leg_geometry(model.model, side, legs_[static_cast<std::size_t>(side)])) {
      throw std::logic_error("a robot model without legs");
    }
  }
  for (const UpperBodyAngle& angle : gait.upper_body) {
    const std::vector<sim_board::MirroredJoint> joints = robot.find_joints(angle.joint);
    if (joints.empty()) {
      throw InputError(gait.file, angle.line, "the joint '" + angle.joint + "'", "a joint of " + robot.name);
    }
    for (const auto& [joint, sign] : joints)
      upper_body_rad_[static_cast<std::size_t>(joint)] = sign * angle.angle_rad;
  }
}

std::vector<double> WalkingPose::targets_rad(const GaitInstant& instant) const {
  Isometry3d X_WB = Isometry3d::Identity();
  X_WB.linear() = Eigen::AngleAxisd(gait_.trunk_pitch_rad, Vector3d::UnitY()).toRotationMatrix();
  const Vector3d wanted_W(instant.com_W_m.x(), instant.com_W_m.y(), gait_.com_height_m);
  X_WB.translation() = wanted_W;
  X_WB.translation() = wanted_W - tree_.centre_of_mass(tree_.poses(X_WB, upper_body_rad_)) + wanted_W;
  std::vector<double> angles_rad;
  for (int round = 0; round < kRounds; ++round) {
    angles_rad = solve_legs(instant, X_WB);
    X_WB.translation() += wanted_W - tree_.centre_of_mass(tree_.poses(X_WB, angles_rad));
  }
  compensate_sag(instant, X_WB, angles_rad);
  check_limits(angles_rad);
  return angles_rad;
}

std::vector<double> WalkingPose::solve_legs(const GaitInstant& instant, const Isometry3d& X_WB) const {
  std::vector<double> angles_rad = upper_body_rad_;
  for (std::size_t side = 0; side < legs_.size(); ++side) {
    const robot::Pose X_BSole = fixed_pose(X_WB.inverse() * instant.X_WSole[side]);
    const robot::LegAngles leg = robot::leg_inverse_kinematics(model_.model, legs_[side], X_BSole);
    if (!leg.reached)
      throw InputError(gait_.file, 0, "a walk whose legs do not reach",
                       "a lower com_height_m, or smaller steps", "the reach of the legs");
    if (std::abs(fixed::to_double(leg.missing_heading)) > kMaxMissingHeading_rad)
      throw InputError(gait_.file, 0, "a walk that turns the feet of legs without hip yaw",
                       "a walk that keeps its heading", "the joints of the legs");
    for (const robot::LegJoint i : legs_[side].chain()) {
      angles_rad[legs_[side].joints[i]] = fixed::to_double(leg.angles[i]);
    }
  }
  return angles_rad;
}

// A loaded servo deviates from its target by torque over stiffness. The load of a leg joint is the static
// moment of the ground reaction force, less the weight of the links below the joint.
void WalkingPose::compensate_sag(const GaitInstant& instant, const Isometry3d& X_WB,
                                 std::vector<double>& angles_rad) const {
  const std::vector<Isometry3d> X_WLs = tree_.poses(X_WB, angles_rad);
  const double g = sim_board::kGravity_m_per_s2;
  for (std::size_t side = 0; side < legs_.size(); ++side) {
    Vector3d force_W(0.0, 0.0, instant.load_share[side] * robot_.total_mass_kg() * g);
    const Vector3d zmp_W(instant.zmp_W_m.x(), instant.zmp_W_m.y(), 0.0);
    // In double support each foot carries its share at its own ZMP.
    const Vector3d sole_W = instant.X_WSole[side].translation();
    const Vector3d p_W = instant.load_share[side] >= 1.0 ? zmp_W : sole_W;
    Vector3d moment_W = p_W.cross(force_W);  // about the world's origin
    const auto chain = legs_[side].chain();
    for (auto i = chain.rbegin(); i != chain.rend(); ++i) {
      const std::size_t joint_index = legs_[side].joints[*i];
      const sim_board::JointDescription& joint = robot_.hinge(legs_[side].hinges[*i]);
      const auto child = static_cast<std::size_t>(joint.child);
      const sim_board::LinkDescription& link = robot_.links[child];
      const Vector3d weight_W(0.0, 0.0, -link.mass_kg * g);
      force_W += weight_W;
      moment_W += (X_WLs[child] * link.p_LCom_L).cross(weight_W);
      const Vector3d axis_W = X_WLs[child].linear() * joint.axis_M;
      const Vector3d anchor_W = X_WLs[child].translation();
      if (*i == robot::kHipYaw && legs_[side].shares_yaw) continue;  // of both legs
      const double load_Nm = axis_W.dot(moment_W - anchor_W.cross(force_W));
      angles_rad[joint_index] -=
          gait_.sag_compensation * load_Nm / stiffness_Nm_per_rad(robot_.joints[joint_index].servo);
    }
  }
}

void WalkingPose::check_limits(const std::vector<double>& angles_rad) const {
  for (std::size_t joint = 0; joint < angles_rad.size(); ++joint) {
    const sim_board::JointDescription& limits = robot_.joints[joint];
    if (angles_rad[joint] >= limits.lower_rad && angles_rad[joint] <= limits.upper_rad) continue;
    throw InputError(
        gait_.file, 0,
        "a walk that takes " + limits.name + " to " + degrees_text(angles_rad[joint]) + " degrees",
        degrees_text(limits.lower_rad) + " to " + degrees_text(limits.upper_rad),
        "the limits of " + limits.name);
  }
}

}  // namespace koboshi::simulation
