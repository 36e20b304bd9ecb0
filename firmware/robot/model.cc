#include "firmware/robot/model.h"

#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"
#include "firmware/robot/model_check.h"
#include "firmware/storage/image.h"

namespace koboshi::robot {

using storage::ImageReader;
using storage::ImageStatus;

namespace {

// The fields are in the order of docs/reference/robot-model-format.md.
constexpr std::size_t kFixedPartSize = 1 + kModelNameSize + 16 + 4 + 36 + 16 + 2 * 32;
constexpr std::size_t kJointSize = 75;
// The sensors other than an inertial unit in the base and six-axis ankle sensors; a robot with these has no
// such part, so that its image is that of older versions.
constexpr std::size_t kSensorPartSize = 2 + 2 * hal::kPressureCells * 8;

// The followers; a robot without any has no such part. Its size differs from that of the sensors.
constexpr std::size_t kFollowerSize = kJointSize + 1 + 4 + 4;
constexpr std::size_t follower_part_size(std::size_t followers) {
  return followers == 0 ? 0 : 1 + followers * kFollowerSize;
}
static_assert((kSensorPartSize - 1) % kFollowerSize != 0);

template <fixed::AnyQuantity Q>
void read(ImageReader& reader, Q& quantity) {
  quantity = Q::from_raw(reader.i32());
}

template <fixed::AnyQuantity Q>
void read(ImageReader& reader, Vector<Q>& vector) {
  read(reader, vector.x);
  read(reader, vector.y);
  read(reader, vector.z);
}

void read(ImageReader& reader, Foot& foot) {
  read(reader, foot.ankle_height);
  read(reader, foot.back);
  read(reader, foot.front);
  read(reader, foot.right);
  read(reader, foot.left);
  read(reader, foot.sensor);
}

void read(ImageReader& reader, Joint& joint) {
  joint.role = static_cast<JointRole>(reader.u8());
  joint.parent = LinkIndex::from_raw(reader.i8());
  joint.mirror = JointIndex(reader.u8());
  joint.mirror_sign = reader.i8();
  joint.drive.node_id = reader.u8();
  joint.drive.sign = reader.i8();
  joint.drive.position_bits = reader.u8();
  read(reader, joint.anchor);
  read(reader, joint.axis);
  read(reader, joint.lower);
  read(reader, joint.upper);
  read(reader, joint.max_speed);
  read(reader, joint.drive.zero);
  joint.drive.vendor_id = reader.u32();
  joint.drive.product_code = reader.u32();
  joint.drive.serial_number = reader.u32();
  read(reader, joint.mass);
  read(reader, joint.centre_of_mass);
}

void read_follower_part(ImageReader& reader, RobotModel& model) {
  static_cast<void>(reader.u8());  // their number, which the size has told
  for (std::size_t i = 0; i < model.follower_count; ++i) {
    read(reader, model.joints[model.joint_count + i]);
    Coupling& coupling = model.couplings[i];
    coupling.leader = JointIndex(reader.u8());
    read(reader, coupling.multiplier);
    read(reader, coupling.offset);
  }
}

void read_sensor_part(ImageReader& reader, RobotModel& model) {
  model.ankle_kind = static_cast<hal::AnkleKind>(reader.u8());
  model.imu_link = LinkIndex::from_raw(reader.i8());
  for (Foot& foot : model.feet) {
    for (Cell& cell : foot.cells) {
      read(reader, cell.x);
      read(reader, cell.y);
    }
  }
}

void read_fixed_part(ImageReader& reader, RobotModel& model) {
  for (char& letter : model.name) letter = static_cast<char>(reader.u8());
  read(reader, model.base_mass);
  read(reader, model.base_centre_of_mass);
  read(reader, model.body_height);
  for (Direction& row : model.R_BI.rows) read(reader, row);
  read(reader, model.scales.gyro);
  read(reader, model.scales.accelerometer);
  read(reader, model.scales.ankle_force);
  read(reader, model.scales.ankle_torque);
  for (Foot& foot : model.feet) read(reader, foot);
}

}  // namespace

ModelStatus load_model(std::span<const std::byte> image_bytes, RobotModel& model) {
  storage::Image image;
  const ImageStatus opened = storage::open_image(image_bytes, kModelMagic, kModelVersion, image);
  if (opened != ImageStatus::kOk) return static_cast<ModelStatus>(opened);

  model = {};
  model.id = image.crc32;
  ImageReader reader(image.body);
  model.joint_count = reader.u8();
  if (model.joint_count == 0 || model.joint_count > kMaxJoints) return ModelStatus::kBadJointCount;
  const std::size_t size = kFixedPartSize + model.joint_count * kJointSize;
  bool has_sensor_part = false;
  const auto is_size = [&](bool sensors, std::size_t followers) {
    has_sensor_part = sensors;
    model.follower_count = followers;
    return image.body.size() == size + (sensors ? kSensorPartSize : 0) + follower_part_size(followers);
  };
  bool fits = false;
  for (std::size_t followers = 0; followers <= kMaxFollowers && !fits; ++followers)
    fits = is_size(false, followers) || is_size(true, followers);
  if (!fits) return ModelStatus::kBadSize;
  if (model.hinge_count() > kMaxJoints) return ModelStatus::kBadJointCount;

  read_fixed_part(reader, model);
  for (std::size_t i = 0; i < model.joint_count; ++i) read(reader, model.joints[i]);
  if (has_sensor_part) read_sensor_part(reader, model);
  if (model.follower_count > 0) read_follower_part(reader, model);
  return check_model(model);
}

std::optional<JointIndex> RobotModel::find(JointRole role) const {
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (joints[i].role == role) return JointIndex(i);
  }
  return std::nullopt;
}

std::optional<JointIndex> RobotModel::find_hinge(JointRole role) const {
  for (std::size_t i = 0; i < hinge_count(); ++i) {
    if (joints[i].role == role) return JointIndex(i);
  }
  return std::nullopt;
}

bool RobotModel::leads(JointIndex joint) const {
  for (std::size_t i = 0; i < follower_count; ++i) {
    if (couplings[i].leader == joint) return true;
  }
  return false;
}

fixed::Angle RobotModel::follower_angle(std::span<const fixed::Angle> angles, JointIndex follower) const {
  const Coupling& of_follower = coupling(follower);
  return fixed::product<fixed::Angle>(angles[of_follower.leader], of_follower.multiplier) +
         of_follower.offset;
}

std::array<JointIndex, kLegJoints> RobotModel::leg(hal::Side side) const {
  std::array<JointIndex, kLegJoints> indices{};
  for (std::size_t i = 0; i < kLegJoints; ++i) indices[i] = find(leg_role(side, i)).value_or(JointIndex());
  return indices;
}

std::uint32_t RobotModel::leg_joints() const {
  return leg_joints(hal::Side::kLeft) | leg_joints(hal::Side::kRight);
}

std::uint32_t RobotModel::leg_joints(hal::Side side) const {
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (joints[i].role >= leg_role(side, 0) && joints[i].role <= leg_role(side, kLegJoints - 1))
      mask |= 1u << i;
  }
  return mask;
}

JointIndex RobotModel::foot_joint(hal::Side side) const {
  const JointRole first = leg_role(side, 0);
  const JointRole last = leg_role(side, kLegJoints - 1);
  JointIndex foot;
  for (std::size_t step = 0; step < hinge_count(); ++step) {
    const JointRole role = joints[order[step]].role;
    if (role >= first && role <= last) foot = order[step];
  }
  return foot;
}

fixed::Angle joint_angle(const Drive& drive, std::int32_t position) {
  const std::int64_t shaft_raw =
      std::int64_t{position} * (std::int32_t{1} << (fixed::Angle::kFractionBits - drive.position_bits));
  const std::int64_t angle_raw = drive.sign * (shaft_raw - drive.zero.raw());
  return fixed::Angle::from_raw(fixed::saturate<std::int32_t>(angle_raw));
}

}  // namespace koboshi::robot
