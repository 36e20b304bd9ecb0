#include "simulation/model/robot_model.h"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "firmware/fixed/host/convert.h"
#include "simulation/model/fields.h"
#include "simulation/model/image_writer.h"

namespace koboshi::simulation {
namespace {

using sim_board::RobotDescription;

void write_foot(ImageWriter& writer, const robot::Foot& foot) {
  writer.quantity(foot.ankle_height);
  writer.quantity(foot.back);
  writer.quantity(foot.front);
  writer.quantity(foot.right);
  writer.quantity(foot.left);
  writer.vector(foot.sensor);
}

void write_body(ImageWriter& writer, const robot::RobotModel& model) {
  writer.u8(static_cast<std::uint8_t>(model.joint_count));
  for (const char letter : model.name) writer.u8(static_cast<std::uint8_t>(letter));
  writer.quantity(model.base_mass);
  writer.vector(model.base_centre_of_mass);
  writer.quantity(model.body_height);
  for (const robot::Direction& row : model.R_BI.rows) writer.vector(row);
  writer.quantity(model.scales.gyro);
  writer.quantity(model.scales.accelerometer);
  writer.quantity(model.scales.ankle_force);
  writer.quantity(model.scales.ankle_torque);
  for (const robot::Foot& foot : model.feet) write_foot(writer, foot);
}

void write_joint(ImageWriter& writer, const robot::Joint& joint) {
  writer.u8(static_cast<std::uint8_t>(joint.role));
  writer.i8(joint.parent.raw());
  writer.u8(static_cast<std::uint8_t>(joint.mirror));
  writer.i8(joint.mirror_sign);
  writer.u8(joint.drive.node_id);
  writer.i8(joint.drive.sign);
  writer.u8(joint.drive.position_bits);
  writer.vector(joint.anchor);
  writer.vector(joint.axis);
  writer.quantity(joint.lower);
  writer.quantity(joint.upper);
  writer.quantity(joint.max_speed);
  writer.quantity(joint.drive.zero);
  writer.u32(joint.drive.vendor_id);
  writer.u32(joint.drive.product_code);
  writer.u32(joint.drive.serial_number);
  writer.quantity(joint.mass);
  writer.vector(joint.centre_of_mass);
}

// Only where the sensors are others than an inertial unit in the base and six axes in the ankles.
void write_sensors(ImageWriter& writer, const robot::RobotModel& model) {
  if (model.ankle_kind == hal::AnkleKind::kSixAxis && model.imu_link.is_trunk()) return;
  writer.u8(static_cast<std::uint8_t>(model.ankle_kind));
  writer.i8(model.imu_link.raw());
  for (const robot::Foot& foot : model.feet) {
    for (const robot::Cell& cell : foot.cells) {
      writer.quantity(cell.x);
      writer.quantity(cell.y);
    }
  }
}

// Only of a robot that has any.
void write_followers(ImageWriter& writer, const robot::RobotModel& model) {
  if (model.follower_count == 0) return;
  writer.u8(static_cast<std::uint8_t>(model.follower_count));
  for (std::size_t i = 0; i < model.follower_count; ++i) {
    write_joint(writer, model.joints[model.joint_count + i]);
    writer.u8(static_cast<std::uint8_t>(model.couplings[i].leader));
    writer.quantity(model.couplings[i].multiplier);
    writer.quantity(model.couplings[i].offset);
  }
}

constexpr std::array<std::string_view, 17> kModelStatusTexts{
    "a good robot model",
    "a robot model cut short",
    "something that is no robot model",
    "a robot model of another version",
    "a robot model with a wrong size",
    "a robot model with a CRC-32 that does not fit",
    "a number of joints beyond what the firmware has room for",
    "a sign, role, node id, index or unit without meaning",
    "a length, mass, speed or sensor scale out of range",
    "an axis that is no unit vector, or an inertial unit whose axes are no rotation",
    "a joint whose lower limit is above its upper one",
    "joints that carry each other in a circle",
    "two drives with one node id",
    "two joints with one role",
    "a left-right table that does not lead back",
    "a side without a leg, or a leg with joints that cannot move its sole in all directions",
    "a joint that follows another one which has no drive or a second follower, or at a ratio out of range",
};

std::optional<robot::Position> hand_tip(const RobotDescription& robot, const robot::RobotModel& model,
                                        robot::JointRole elbow) {
  const auto index = model.find(elbow);
  if (!index) return std::nullopt;
  const sim_board::JointDescription& joint = robot.joints.at(*index);
  const sim_board::LinkDescription& link = robot.links.at(static_cast<std::size_t>(joint.child));
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  for (const sim_board::BoxDescription& box : link.collisions) {
    for (int face = 0; face < 6; ++face) {
      const Eigen::Vector3d p_G =
          (face % 2 == 0 ? 0.5 : -0.5) * box.size_m[face / 2] * Eigen::Vector3d::Unit(face / 2);
      const Eigen::Vector3d p_M = link.X_ML * (box.X_LG * p_G) - joint.p_MJ;
      if (p_M.norm() > tip.norm()) tip = p_M;
    }
  }
  if (tip.isZero()) return std::nullopt;
  const Eigen::Vector3d tip_B = robot.links.at(0).X_ML.linear().transpose() * tip;
  const auto length = [](double value_m) { return fixed::from_double<fixed::Length>(value_m); };
  return robot::Position{length(tip_B.x()), length(tip_B.y()), length(tip_B.z())};
}

std::vector<std::byte> make_image(const RobotDescription& robot, std::vector<InputError>& errors) {
  const robot::RobotModel fields = model_fields(robot, errors);
  if (!errors.empty()) return {};
  ImageWriter writer;
  write_body(writer, fields);
  for (std::size_t i = 0; i < fields.joint_count; ++i) write_joint(writer, fields.joints[i]);
  write_sensors(writer, fields);
  write_followers(writer, fields);
  std::vector<std::byte> image = writer.finish(robot::kModelMagic, robot::kModelVersion);
  robot::RobotModel loaded;
  const robot::ModelStatus status = robot::load_model(image, loaded);
  if (status != robot::ModelStatus::kOk)
    errors.emplace_back(robot.file, robot.line, describe(status), "a robot that the firmware can run on");
  return image;
}

}  // namespace

std::string describe(robot::ModelStatus status) {
  return std::string(kModelStatusTexts.at(static_cast<std::size_t>(status)));
}

std::vector<std::byte> make_robot_model(const RobotDescription& robot) {
  std::vector<InputError> errors;
  std::vector<std::byte> image = make_image(robot, errors);
  if (!errors.empty()) throw errors.front();
  return image;
}

std::vector<InputError> find_model_errors(const RobotDescription& robot) {
  std::vector<InputError> errors;
  static_cast<void>(make_image(robot, errors));
  return errors;
}

NamedModel load_named_model(const RobotDescription& robot) {
  NamedModel named{
      .robot = robot.name, .joint_names = robot.joint_names(), .image = make_robot_model(robot), .model = {}};
  if (robot::load_model(named.image, named.model) != robot::ModelStatus::kOk) {
    throw std::logic_error("a valid robot model could not be loaded again");
  }
  for (const sim_board::JointDescription& joint : robot.joints) {
    named.joint_roles.push_back(joint.role());
    named.encoder_steps_rad.push_back(std::ldexp(2.0 * std::numbers::pi, -joint.encoder.bits));
  }
  named.hands = {hand_tip(robot, named.model, robot::JointRole::kLeftElbow),
                 hand_tip(robot, named.model, robot::JointRole::kRightElbow)};
  return named;
}

}  // namespace koboshi::simulation
