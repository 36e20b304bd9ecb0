#include "simulation/model/fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/model/bus_load.h"
#include "simulation/model/foot.h"
#include "simulation/model/leg_faults.h"

namespace koboshi::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using fixed::from_double;
using sim_board::JointDescription;
using sim_board::RobotDescription;

constexpr std::uint8_t kDrivePositionBits = 20;  // CiA 402 position unit of our drives: 2^-20 turn

// Indexed by robot::JointRole.
constexpr std::array<std::string_view, robot::kRoleCount> kRoleNames{
    "",
    "head_pan",
    "head_tilt",
    "left_hip_yaw",
    "left_hip_roll",
    "left_hip_pitch",
    "left_knee",
    "left_ankle_pitch",
    "left_ankle_roll",
    "right_hip_yaw",
    "right_hip_roll",
    "right_hip_pitch",
    "right_knee",
    "right_ankle_pitch",
    "right_ankle_roll",
    "left_shoulder_pitch",
    "left_shoulder_roll",
    "left_elbow",
    "right_shoulder_pitch",
    "right_shoulder_roll",
    "right_elbow",
};

robot::JointRole role_of(const std::string& role) {
  const auto found = std::find(kRoleNames.begin() + 1, kRoleNames.end(), role);
  return found == kRoleNames.end() ? robot::JointRole::kOther
                                   : static_cast<robot::JointRole>(found - kRoleNames.begin());
}

// Converts a link's index to the firmware's numbering.
robot::LinkIndex link_index(const RobotDescription& robot, int link) {
  if (link == 0) return {};
  for (std::size_t i = 0; i < robot.hinge_count(); ++i) {
    if (robot.hinge(i).child == link) return robot::LinkIndex(robot::JointIndex(i));
  }
  throw InputError(robot.file, robot.links.at(static_cast<std::size_t>(link)).line,
                   "a link that no joint carries, " + robot.links.at(static_cast<std::size_t>(link)).name,
                   "a tree of joints that begins at the base");
}

void set_mirror(const RobotDescription& robot, std::size_t index, robot::Joint& joint) {
  const JointDescription& described = robot.joints[index];
  // The image of a joint that moves both sides is the joint itself.
  if (const auto* follower = robot.mirrored_follower(static_cast<int>(index))) {
    const double cosine = sim_board::mirrored_axis(described.axis_M).dot(follower->hinge.axis_M);
    joint.mirror = robot::JointIndex(index);
    joint.mirror_sign = cosine * follower->multiplier < 0.0 ? std::int8_t{-1} : std::int8_t{1};
    return;
  }
  const int mirror = robot.mirror_of(static_cast<int>(index));
  const std::string& partner = robot.joints.at(static_cast<std::size_t>(mirror)).name;
  joint.mirror = robot::JointIndex(mirror);
  const double cosine = sim_board::mirrored_axis(described.axis_M).dot(robot.joints[joint.mirror].axis_M);
  if (partner != described.name && std::abs(cosine) < 1.0 - 1e-9) {
    throw InputError(robot.file, described.line,
                     "axes of " + described.name + " and " + partner + " that are no mirror images",
                     "a left and a right joint with one axis or its opposite, mirrored");
  }
  joint.mirror_sign = cosine < 0.0 ? std::int8_t{-1} : std::int8_t{1};
}

// Limits of the firmware's image, checked here because the link's name and line are known.
fixed::Mass mass_of(const RobotDescription& robot, std::size_t link) {
  const sim_board::LinkDescription& described = robot.links.at(link);
  const double max_kg = fixed::to_double(robot::kMaxLinkMass);
  if (described.mass_kg > max_kg) {
    throw InputError(
        robot.file, described.mass_line,
        "a mass of " + number_text(described.mass_kg) + " kg in link " + described.name,
        "at most " + number_text(max_kg) + " kg a link, the most that the firmware can represent");
  }
  return from_double<fixed::Mass>(described.mass_kg);
}

void check_total_mass(const RobotDescription& robot) {
  const double max_link_kg = fixed::to_double(robot::kMaxLinkMass);
  const double max_kg = fixed::to_double(robot::kMaxRobotMass);
  const bool has_heavy_link = std::ranges::any_of(
      robot.links, [&](const sim_board::LinkDescription& link) { return link.mass_kg > max_link_kg; });
  if (has_heavy_link || robot.total_mass_kg() <= max_kg) return;  // that link has an error of its own
  throw InputError(robot.file, robot.line, number_text(robot.total_mass_kg()) + " kg in all links together",
                   "at most " + number_text(max_kg) + " kg, the most that the firmware can represent");
}

void check_bus_load(const RobotDescription& robot) {
  const double load = bus_load(robot.joints.size(), false).longest;
  if (load <= kMaxBusLoad) return;
  throw InputError(
      robot.file, robot.line,
      fmt::format("{} drives, which load the bus by up to {:.1f} %", robot.joints.size(), 100.0 * load),
      fmt::format("at most {:.0f} %", 100.0 * kMaxBusLoad));
}

robot::Drive drive_fields(const sim_board::DriveDescription& drive) {
  return {.node_id = drive.node_id,
          .sign = static_cast<std::int8_t>(drive.sign),
          .position_bits = kDrivePositionBits,
          .zero = from_double<fixed::Angle>(drive.zero_rad),
          .vendor_id = drive.vendor_id,
          .product_code = drive.product_code,
          .serial_number = drive.serial_number};
}

// The zero pose in the base's axes, which the firmware uses for all vectors.
class BaseFrame {
 public:
  explicit BaseFrame(const RobotDescription& robot)
      : robot_(robot), X_BM_(robot.links.at(0).X_ML.inverse()) {}

  robot::Position offset(const Vector3d& from_M, const Vector3d& to_M) const {
    return fixed_position(X_BM_.linear() * (to_M - from_M));
  }
  robot::Direction direction(const Vector3d& v_M) const {
    const Vector3d v_B = (X_BM_.linear() * v_M).normalized();
    return {from_double<fixed::Ratio>(v_B.x()), from_double<fixed::Ratio>(v_B.y()),
            from_double<fixed::Ratio>(v_B.z())};
  }
  Vector3d centre_of_mass_M(int link) const {
    const sim_board::LinkDescription& described = robot_.links.at(static_cast<std::size_t>(link));
    return described.X_ML * described.p_LCom_L;
  }

 private:
  const RobotDescription& robot_;
  Isometry3d X_BM_;
};

// Converts a joint limit. Half a turn is often written with a few digits, just above or below the exact
// value.
fixed::Angle limit(double angle_rad) {
  return from_double<fixed::Angle>(std::clamp(angle_rad, -std::numbers::pi, std::numbers::pi));
}

// Of a joint or, behind these, of a follower.
robot::Joint joint_fields(const RobotDescription& robot, const BaseFrame& frame, std::size_t index) {
  const JointDescription& described = robot.hinge(index);
  robot::Joint joint;
  joint.role = role_of(described.role());
  joint.parent = link_index(robot, described.parent);
  if (index < robot.joints.size()) set_mirror(robot, index, joint);
  const Vector3d parent_M = joint.parent.is_trunk() ? Vector3d(robot.links[0].X_ML.translation())
                                                    : robot.hinge(joint.parent.joint()).p_MJ;
  joint.anchor = frame.offset(parent_M, described.p_MJ);
  joint.axis = frame.direction(described.axis_M);
  joint.lower = limit(described.lower_rad);
  joint.upper = limit(described.upper_rad);
  joint.max_speed = from_double<fixed::AngularRate>(described.max_speed_rad_per_s);
  if (index < robot.joints.size()) joint.drive = drive_fields(described.drive);
  joint.mass = mass_of(robot, static_cast<std::size_t>(described.child));
  joint.centre_of_mass = frame.offset(described.p_MJ, frame.centre_of_mass_M(described.child));
  return joint;
}

void set_inertial_unit(const RobotDescription& robot, const BaseFrame& frame, robot::RobotModel& model) {
  if (!robot.imu) throw InputError(robot.file, robot.line, "no inertial unit", "one in any link");
  model.imu_link = link_index(robot, robot.imu->link);
  const Isometry3d X_MI = robot.links.at(static_cast<std::size_t>(robot.imu->link)).X_ML * robot.imu->X_LS;
  const auto R_IB =
      robot::Rotation{{frame.direction(X_MI.linear().col(0)), frame.direction(X_MI.linear().col(1)),
                       frame.direction(X_MI.linear().col(2))}};
  model.R_BI = robot::transpose(R_IB);
  model.scales.gyro = from_double<fixed::AngularRate>(robot.imu->gyro.resolution * kFullScaleCounts);
  model.scales.accelerometer =
      from_double<fixed::Acceleration>(robot.imu->accelerometer.resolution * kFullScaleCounts);
}

void set_name(const RobotDescription& robot, robot::RobotModel& model) {
  if (robot.name.empty() || robot.name.size() > robot::kModelNameSize) {
    throw InputError(robot.file, robot.line, "the robot's name '" + one_line(robot.name) + "'",
                     "a name of 1 to " + std::to_string(robot::kModelNameSize) + " letters");
  }
  std::copy(robot.name.begin(), robot.name.end(), model.name.begin());
}

void check_joint(const RobotDescription& robot, const JointDescription& joint) {
  const auto whole_turn = [](double angle_rad) {
    return std::abs(angle_rad) <= std::numbers::pi * (1.0 + 1e-6);
  };
  if (!whole_turn(joint.lower_rad) || !whole_turn(joint.upper_rad)) {
    throw InputError(robot.file, joint.line, "limits of " + joint.name + " beyond half a turn",
                     "limits within +-180 degrees");
  }
  if (std::abs(joint.drive.sign) != 1) {
    throw InputError(robot.file, joint.line,
                     "a drive sign of " + joint.name + " of " + std::to_string(joint.drive.sign), "1 or -1");
  }
}

void check_offset(const RobotDescription& robot, int line, const std::string& what, const std::string& from,
                  const robot::Position& offset) {
  const double max_m = fixed::to_double(robot::kMaxOffset);
  for (const fixed::Length length : {offset.x, offset.y, offset.z}) {
    if (fixed::abs(length) <= robot::kMaxOffset) continue;
    throw InputError(robot.file, line,
                     what + " at more than " + number_text(max_m) + " m from " + from + " along an axis",
                     "at most that, the most that the firmware can represent");
  }
}

// Refuses what the firmware would refuse without the joint's name.
void check_fields(const RobotDescription& robot, const JointDescription& joint, const robot::Joint& fields) {
  check_offset(robot, joint.line, "joint " + joint.name, "the joint that carries it", fields.anchor);
  check_offset(robot, robot.links.at(static_cast<std::size_t>(joint.child)).line,
               "the centre of mass of " + robot.links.at(static_cast<std::size_t>(joint.child)).name,
               "joint " + joint.name, fields.centre_of_mass);
  if (fields.max_speed <= fixed::AngularRate())
    throw InputError(robot.file, joint.line, "no speed of joint " + joint.name, "a speed above zero");
}

}  // namespace

robot::RobotModel model_fields(const RobotDescription& robot, std::vector<InputError>& errors) {
  robot::RobotModel model;
  if (robot.joints.empty() || robot.hinge_count() > robot::kMaxJoints) {
    errors.emplace_back(robot.file, robot.line, std::to_string(robot.hinge_count()) + " joints",
                        "1 to " + std::to_string(robot::kMaxJoints));
    return model;
  }
  if (robot.followers.size() > robot::kMaxFollowers) {
    errors.emplace_back(robot.file, robot.line,
                        std::to_string(robot.followers.size()) + " joints with <mimic>",
                        "at most " + std::to_string(robot::kMaxFollowers));
    return model;
  }
  const BaseFrame frame(robot);
  collect_error(errors, [&] { set_name(robot, model); });
  collect_error(errors, [&] { check_total_mass(robot); });
  collect_error(errors, [&] { check_bus_load(robot); });
  const std::size_t errors_before = errors.size();
  model.joint_count = robot.joints.size();
  model.follower_count = robot.followers.size();
  for (std::size_t i = 0; i < robot.hinge_count(); ++i) {
    collect_error(errors, [&] {
      check_joint(robot, robot.hinge(i));
      model.joints[i] = joint_fields(robot, frame, i);
      check_fields(robot, robot.hinge(i), model.joints[i]);
    });
  }
  for (std::size_t i = 0; i < robot.followers.size(); ++i)
    model.couplings[i] = {.leader = robot::JointIndex(robot.followers[i].leader),
                          .multiplier = from_double<fixed::Gain>(robot.followers[i].multiplier),
                          .offset = from_double<fixed::Angle>(robot.followers[i].offset_rad)};
  if (errors.size() == errors_before) find_leg_faults(robot, model, errors);
  collect_error(errors, [&] {
    model.base_mass = mass_of(robot, 0);
    model.base_centre_of_mass = frame.offset(robot.links[0].X_ML.translation(), frame.centre_of_mass_M(0));
    check_offset(robot, robot.links[0].line, "the centre of mass of " + robot.links[0].name, "its frame",
                 model.base_centre_of_mass);
  });
  model.body_height = body_height(robot);
  collect_error(errors, [&] { set_inertial_unit(robot, frame, model); });
  set_feet(robot, model, errors);
  return model;
}

}  // namespace koboshi::simulation
