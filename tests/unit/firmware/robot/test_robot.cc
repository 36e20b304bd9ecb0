#include "tests/unit/firmware/robot/test_robot.h"

#include <algorithm>

namespace koboshi::test {
namespace {

using fixed::from_double;
using robot::Direction;
using robot::Joint;
using robot::JointIndex;
using robot::JointRole;
using robot::LinkIndex;
using robot::RobotModel;

struct Row {
  JointRole first_role;
  int parent;  // relative to this joint; 0: the base
  robot::Position anchor;
  Direction axis;
  double lower_deg;
  double upper_deg;
  double mass_kg;
  robot::Position centre_of_mass;
};

void add(RobotModel& model, int role_offset, const Row& row) {
  const auto index = model.joint_count++;
  Joint& joint = model.joints[index];
  joint.role = static_cast<JointRole>(static_cast<int>(row.first_role) + role_offset);
  if (row.parent != 0) joint.parent = LinkIndex(JointIndex(static_cast<int>(index) + row.parent));
  joint.anchor = row.anchor;
  joint.axis = row.axis;
  joint.lower = degrees(row.lower_deg);
  joint.upper = degrees(row.upper_deg);
  joint.max_speed = from_double<fixed::AngularRate>(7.48);
  joint.mirror = JointIndex(index);
  joint.drive.node_id = static_cast<std::uint8_t>(16 + index);
  joint.drive.vendor_id = 0x4B4F4249;
  joint.drive.product_code = 1;
  joint.drive.serial_number = 1000 + static_cast<std::uint32_t>(index);
  joint.mass = from_double<fixed::Mass>(row.mass_kg);
  joint.centre_of_mass = row.centre_of_mass;
}

void pair(RobotModel& model, std::size_t left, std::size_t right, int sign) {
  model.joints[left].mirror = JointIndex(right);
  model.joints[right].mirror = JointIndex(left);
  model.joints[left].mirror_sign = model.joints[right].mirror_sign = static_cast<std::int8_t>(sign);
}

// The roll signs of the sides are opposite: both joints turn about the same axis.
void add_leg(RobotModel& model, JointRole first, double side) {
  using robot::kAxisX;
  using robot::kAxisY;
  using robot::kAxisZ;
  const double roll_in = side > 0 ? -40 : -90;
  const double roll_out = side > 0 ? 90 : 40;
  add(model, 0, {first, 0, position(0, 0.03 * side, 0), kAxisZ, -90, 90, 0.044, position(-0.016, 0, 0.01)});
  add(model, 1, {first, -1, position(0, 0, 0), kAxisX, roll_in, roll_out, 0.044, position(0.012, 0, 0.004)});
  add(model, 2, {first, -1, position(0, 0, 0), kAxisY, -120, 60, 0.048, position(0, 0, -0.037)});
  add(model, 3, {first, -1, position(0, 0, -0.065), kAxisY, 0, 150, 0.05, position(0, 0, -0.033)});
  add(model, 4, {first, -1, position(0, 0, -0.065), kAxisY, -90, 75, 0.044, position(-0.01, 0, -0.008)});
  add(model, 5, {first, -1, position(0, 0, 0), kAxisX, -60, 60, 0.051, position(0.012, 0, -0.032)});
}

void add_arm(RobotModel& model, JointRole first, double side) {
  using robot::kAxisX;
  using robot::kAxisY;
  const double roll_in = side > 0 ? -15 : -135;
  const double roll_out = side > 0 ? 135 : 15;
  add(model, 0, {first, 0, position(0, 0.07 * side, 0.12), kAxisY, -180, 180, 0.044, position(0, 0, 0.004)});
  add(model, 1, {first, -1, position(0, 0, 0), kAxisX, roll_in, roll_out, 0.048, position(0, 0, -0.032)});
  add(model, 2, {first, -1, position(0, 0, -0.07), kAxisY, -135, 135, 0.015, position(0, 0, -0.045)});
}

}  // namespace

RobotModel make_test_robot() {
  RobotModel model;
  const std::string name = "test";
  std::copy(name.begin(), name.end(), model.name.begin());
  add_leg(model, JointRole::kLeftHipYaw, 1);
  add_leg(model, JointRole::kRightHipYaw, -1);
  add_arm(model, JointRole::kLeftShoulderPitch, 1);
  add_arm(model, JointRole::kRightShoulderPitch, -1);
  add(model, 0,
      {JointRole::kHeadPan, 0, position(0, 0, 0.142), robot::kAxisZ, -90, 90, 0.044, position(0, 0, 0.011)});
  add(model, 0,
      {JointRole::kHeadTilt, -1, position(0, 0, 0.018), robot::kAxisY, -60, 60, 0.02, position(0, 0, 0.026)});
  constexpr std::array<int, 6> kLegMirrorSigns{-1, -1, 1, 1, 1, -1};
  for (std::size_t i = 0; i < 6; ++i) pair(model, i, 6 + i, kLegMirrorSigns[i]);
  for (std::size_t i = 0; i < 3; ++i) pair(model, 12 + i, 15 + i, i == 1 ? -1 : 1);
  model.joints[18].mirror_sign = -1;
  model.base_mass = from_double<fixed::Mass>(0.36);
  model.base_centre_of_mass = position(0, 0, 0.083);
  model.body_height = from_double<fixed::Length>(0.38);
  model.scales = {from_double<fixed::AngularRate>(17.45), from_double<fixed::Acceleration>(39.2),
                  from_double<fixed::Force>(100), from_double<fixed::Torque>(5)};
  for (robot::Foot& foot : model.feet) {
    const robot::Position low = position(-0.038, -0.028, 0.04);
    const robot::Position high = position(0.062, 0.028, 0.02);
    foot = {low.z, low.x, high.x, low.y, high.y, {{}, {}, high.z}};
  }
  return model;
}

RobotModel with_shared_yaw(const RobotModel& model, double multiplier) {
  const std::size_t yaw = *model.find(JointRole::kRightHipYaw);
  const std::size_t last = model.joint_count - 1;
  const auto moved = [&](std::size_t index) { return index == yaw ? last : index > yaw ? index - 1 : index; };
  const auto moved_link = [&](LinkIndex link) {
    return link.is_trunk() ? link : LinkIndex(JointIndex(moved(link.joint())));
  };
  RobotModel shared = model;
  for (std::size_t i = 0; i <= last; ++i) {
    Joint joint = model.joints[i];
    joint.parent = moved_link(joint.parent);
    joint.mirror = JointIndex(moved(joint.mirror));
    shared.joints[moved(i)] = joint;
  }
  shared.imu_link = moved_link(model.imu_link);
  const JointIndex leader = *shared.find(JointRole::kLeftHipYaw);
  shared.joints[leader].mirror = leader;
  shared.joints[last].mirror = leader;
  shared.joints[last].drive = {};
  shared.joint_count = last;
  shared.follower_count = 1;
  shared.couplings[0] = {.leader = leader, .multiplier = from_double<fixed::Gain>(multiplier), .offset = {}};
  return shared;
}

void put(std::vector<std::byte>& bytes, std::uint32_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
}

namespace {

template <fixed::AnyQuantity Q>
void put(std::vector<std::byte>& bytes, Q value) {
  test::put(bytes, static_cast<std::uint32_t>(value.raw()), 4);
}

template <fixed::AnyQuantity Q>
void put(std::vector<std::byte>& bytes, const robot::Vector<Q>& v) {
  for (const Q component : {v.x, v.y, v.z}) put(bytes, component);
}

void put_body(std::vector<std::byte>& bytes, const RobotModel& model) {
  test::put(bytes, static_cast<std::uint32_t>(model.joint_count), 1);
  for (const char letter : model.name) bytes.push_back(static_cast<std::byte>(letter));
  put(bytes, model.base_mass);
  put(bytes, model.base_centre_of_mass);
  put(bytes, model.body_height);
  for (const Direction& row : model.R_BI.rows) put(bytes, row);
  put(bytes, model.scales.gyro);
  put(bytes, model.scales.accelerometer);
  put(bytes, model.scales.ankle_force);
  put(bytes, model.scales.ankle_torque);
  for (const robot::Foot& foot : model.feet) {
    for (const auto length : {foot.ankle_height, foot.back, foot.front, foot.right, foot.left})
      put(bytes, length);
    put(bytes, foot.sensor);
  }
}

void put_joint(std::vector<std::byte>& bytes, const Joint& joint) {
  const auto byte = [&](int value) { bytes.push_back(static_cast<std::byte>(value)); };
  byte(static_cast<int>(joint.role));
  byte(joint.parent.raw());
  byte(static_cast<int>(joint.mirror));
  byte(joint.mirror_sign);
  byte(joint.drive.node_id);
  byte(joint.drive.sign);
  byte(joint.drive.position_bits);
  put(bytes, joint.anchor);
  put(bytes, joint.axis);
  put(bytes, joint.lower);
  put(bytes, joint.upper);
  put(bytes, joint.max_speed);
  put(bytes, joint.drive.zero);
  test::put(bytes, joint.drive.vendor_id, 4);
  test::put(bytes, joint.drive.product_code, 4);
  test::put(bytes, joint.drive.serial_number, 4);
  put(bytes, joint.mass);
  put(bytes, joint.centre_of_mass);
}

// The part that a robot with other sensors has.
void put_sensors(std::vector<std::byte>& bytes, const RobotModel& model) {
  bool is_needed = model.ankle_kind != hal::AnkleKind::kSixAxis || !model.imu_link.is_trunk();
  for (const robot::Foot& foot : model.feet) {
    for (const robot::Cell& cell : foot.cells)
      is_needed = is_needed || cell.x != fixed::Length() || cell.y != fixed::Length();
  }
  if (!is_needed) return;
  test::put(bytes, static_cast<std::uint8_t>(model.ankle_kind), 1);
  test::put(bytes, static_cast<std::uint8_t>(model.imu_link.raw()), 1);
  for (const robot::Foot& foot : model.feet) {
    for (const robot::Cell& cell : foot.cells) {
      put(bytes, cell.x);
      put(bytes, cell.y);
    }
  }
}

void put_followers(std::vector<std::byte>& bytes, const RobotModel& model) {
  if (model.follower_count == 0) return;
  test::put(bytes, static_cast<std::uint32_t>(model.follower_count), 1);
  for (std::size_t i = 0; i < model.follower_count; ++i) {
    put_joint(bytes, model.joints[model.joint_count + i]);
    const robot::Coupling& coupling = model.couplings[i];
    test::put(bytes, static_cast<std::uint32_t>(coupling.leader), 1);
    put(bytes, coupling.multiplier);
    put(bytes, coupling.offset);
  }
}

// The textbook's bitwise CRC.
std::uint32_t slow_crc32(const std::vector<std::byte>& bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

}  // namespace

void seal(std::vector<std::byte>& image) {
  std::vector<std::byte> size;
  put(size, static_cast<std::uint32_t>(image.size()), 4);
  std::copy(size.begin(), size.end(), image.begin() + 8);
  std::vector<std::byte> covered = image;
  covered.erase(covered.begin() + 12, covered.begin() + 16);
  std::vector<std::byte> crc;
  put(crc, slow_crc32(covered), 4);
  std::copy(crc.begin(), crc.end(), image.begin() + 12);
}

std::vector<std::byte> encode(const RobotModel& model) {
  std::vector<std::byte> image;
  put(image, robot::kModelMagic, 4);
  put(image, robot::kModelVersion, 4);  // plus the reserved field
  image.resize(16);
  put_body(image, model);
  for (std::size_t i = 0; i < model.joint_count; ++i) put_joint(image, model.joints[i]);
  put_sensors(image, model);
  put_followers(image, model);
  seal(image);
  return image;
}

}  // namespace koboshi::test
