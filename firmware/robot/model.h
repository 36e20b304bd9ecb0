#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"
#include "firmware/robot/geometry.h"
#include "firmware/robot/index.h"
#include "hal/port/ankle.h"
#include "hal/port/side.h"

namespace koboshi::robot {

inline constexpr std::size_t kMaxJoints = 31;  // masks of joints have 32 bits, one of them spare
inline constexpr std::size_t kModelNameSize = 24;
inline constexpr std::uint32_t kModelMagic = 0x444D524Bu;  // "KRMD"
inline constexpr std::uint16_t kModelVersion = 1;

// The function of a joint in the body, by which code finds it on any robot. Legs and arms of both sides are
// in the same order.
enum class JointRole : std::uint8_t {
  kOther = 0,
  kHeadPan,
  kHeadTilt,
  kLeftHipYaw,
  kLeftHipRoll,
  kLeftHipPitch,
  kLeftKnee,
  kLeftAnklePitch,
  kLeftAnkleRoll,
  kRightHipYaw,
  kRightHipRoll,
  kRightHipPitch,
  kRightKnee,
  kRightAnklePitch,
  kRightAnkleRoll,
  kLeftShoulderPitch,
  kLeftShoulderRoll,
  kLeftElbow,
  kRightShoulderPitch,
  kRightShoulderRoll,
  kRightElbow,
};
inline constexpr std::size_t kRoleCount = 21;
inline constexpr std::size_t kLegJoints = 6;

// The role of the leg joint at this place, 0..kLegJoints - 1 from the trunk down (LegJoint in leg.h).
[[nodiscard]] constexpr JointRole leg_role(hal::Side side, std::size_t place) noexcept {
  const JointRole first = side == hal::Side::kLeft ? JointRole::kLeftHipYaw : JointRole::kRightHipYaw;
  return static_cast<JointRole>(static_cast<std::size_t>(first) + place);
}

// The servo drive of a joint. Its position is sign * joint angle + zero, in units of 2^-position_bits turn.
struct Drive {
  std::uint8_t node_id = 0;         // 1..127; no other joint has it
  std::int8_t sign = 1;             // 1 or -1
  std::uint8_t position_bits = 20;  // 8..31
  fixed::Angle zero;
  std::uint32_t vendor_id = 0;  // the identity that its object 0x1018 must have
  std::uint32_t product_code = 0;
  std::uint32_t serial_number = 0;
};

// A hinge and the link that it carries. The link's frame has its origin in the hinge's anchor; at joint zero
// its axes are parallel to those of B. Lengths are at most kMaxOffset in each coordinate.
struct Joint {
  JointRole role = JointRole::kOther;
  LinkIndex parent;             // on which the hinge is mounted
  JointIndex mirror;            // joint of the other side; itself for one in the middle
  std::int8_t mirror_sign = 1;  // 1 or -1: angle of the mirror image = sign * angle
  Position anchor;              // from the parent's anchor, or from B's origin
  Direction axis = kAxisZ;      // unit vector
  fixed::Angle lower;
  fixed::Angle upper;            // lower or more
  fixed::AngularRate max_speed;  // above 0
  Drive drive;
  fixed::Mass mass;         // of the link, 0 to kMaxLinkMass
  Position centre_of_mass;  // in the link's frame
};

// A hinge without a drive: the motor of another joint, its leader, turns it as well. Its angle is
// multiplier * angle of the leader + offset.
struct Coupling {
  JointIndex leader;       // a joint with a drive
  fixed::Gain multiplier;  // 0.05 to 8, or the opposite
  fixed::Angle offset;
};
inline constexpr std::size_t kMaxFollowers = 4;
inline constexpr fixed::Gain kMinMultiplier = fixed::Gain::from_raw(3276);  // 0.05
inline constexpr fixed::Gain kMaxMultiplier = fixed::Gain::from_raw(8 << 16);

// A pressure cell, in the sole's frame.
struct Cell {
  fixed::Length x;
  fixed::Length y;
};

// A foot: the rectangle of its sole and its sensor, in the sole's frame (L, R). That frame lies on the ground
// below the ankle at joint zero; its axes are the foot's, and so are the sensor's. No coordinate exceeds
// kMaxOffset.
struct Foot {
  fixed::Length ankle_height;  // of the joint that carries the foot above the sole, 0 or more
  fixed::Length back;          // x of the heel, negative
  fixed::Length front;
  fixed::Length right;  // y of the edge, negative
  fixed::Length left;
  Position sensor;  // of six axes; its z is the distance d of the paper's equation 1
  std::array<Cell, hal::kPressureCells> cells{};  // of a robot with pressure cells
};

// The full scales of the sensors, at 2^15 counts; above 0, but those of the ankles only where the robot
// measures the forces of its feet.
struct SensorScales {
  fixed::AngularRate gyro;
  fixed::Acceleration accelerometer;
  fixed::Force ankle_force;    // with pressure cells: of the four together, four times that of one
  fixed::Torque ankle_torque;  // with pressure cells: in which their torque about the sole's origin is shown
};

// The robot that the firmware controls, as read from the image in storage. Only calibration parameters change
// it afterwards: the drives' zeros and R_BI.
struct RobotModel {
  std::uint32_t id = 0;                             // the image's CRC-32: motions are bound to it
  std::array<char, kModelNameSize> name{};          // padded with zeros
  std::size_t joint_count = 0;                      // those with a drive; 1..kMaxJoints in a loaded model
  std::size_t follower_count = 0;                   // hinges without one; with the joints at most kMaxJoints
  std::array<Joint, kMaxJoints> joints{};           // those with a drive, then the followers
  std::array<Coupling, kMaxFollowers> couplings{};  // of the followers
  std::array<JointIndex, kMaxJoints> order{};  // of all hinges: each after the one that carries its parent
  fixed::Mass base_mass;                       // above 0, at most kMaxLinkMass
  Position base_centre_of_mass;                // in B; at most kMaxOffset in each coordinate
  fixed::Length body_height;  // from sole to crown at joint zero; above 0, at most 2 * kMaxOffset
  Rotation R_BI;       // from axes of the inertial unit I to those of B at joint zero, and always to those of
                       // the link that carries it
  LinkIndex imu_link;  // that link
  hal::AnkleKind ankle_kind = hal::AnkleKind::kSixAxis;
  SensorScales scales;
  hal::BySide<Foot> feet{};

  // Number of hinges: joints and followers.
  [[nodiscard]] std::size_t hinge_count() const { return joint_count + follower_count; }
  [[nodiscard]] bool is_follower(JointIndex hinge) const { return hinge >= joint_count; }
  // The coupling of a follower to its leader.
  [[nodiscard]] const Coupling& coupling(JointIndex follower) const {
    return couplings[follower - joint_count];
  }
  // Whether the joint's motor turns a follower as well.
  [[nodiscard]] bool leads(JointIndex joint) const;
  // Returns a hinge's angle for those of the joints.
  [[nodiscard]] fixed::Angle hinge_angle(std::span<const fixed::Angle> angles, JointIndex hinge) const {
    return is_follower(hinge) ? follower_angle(angles, hinge) : angles[hinge];
  }
  // Returns the joint with this role, the first one; nothing where the robot has none.
  [[nodiscard]] std::optional<JointIndex> find(JointRole role) const;
  // The same of a joint or a follower.
  [[nodiscard]] std::optional<JointIndex> find_hinge(JointRole role) const;
  // Returns the joints of a leg in the order of LegJoint (leg.h); a missing joint has the index 0.
  [[nodiscard]] std::array<JointIndex, kLegJoints> leg(hal::Side side) const;
  // Returns the joints of both legs, or of one, as a mask, bit i for joint i.
  [[nodiscard]] std::uint32_t leg_joints() const;
  [[nodiscard]] std::uint32_t leg_joints(hal::Side side) const;
  // Returns the joint that carries the foot: the last one of the leg, from the trunk down.
  [[nodiscard]] JointIndex foot_joint(hal::Side side) const;
  // Returns whether the sensors of the feet measure loads and ZMP.
  [[nodiscard]] bool measures_loads() const {
    return ankle_kind == hal::AnkleKind::kSixAxis || ankle_kind == hal::AnkleKind::kPressureCells;
  }

 private:
  [[nodiscard]] fixed::Angle follower_angle(std::span<const fixed::Angle> angles, JointIndex follower) const;
};

enum class [[nodiscard]] ModelStatus : std::uint8_t{
    kOk = 0,
    kTruncated = 1,  // up to kBadCrc as storage::ImageStatus
    kBadMagic = 2, kBadVersion = 3, kBadSize = 4, kBadCrc = 5,
    kBadJointCount = 6,  // 0, or more than kMaxJoints
    kBadField = 7,       // a sign, role, node id, index or unit with a value that has no meaning
    kOutOfRange = 8,     // a length, mass, speed or scale that no such robot has
    kNotARotation = 9,   // an axis that is no unit vector, or an inertial unit's matrix that is no rotation
    kLimitsReversed = 10, kCyclicTree = 11, kDuplicateNodeId = 12, kDuplicateRole = 13,
    kBadMirror = 14,    // the mirror image of a joint's mirror image is not the joint
    kBadLeg = 15,       // no joint of a leg, or one with all but perhaps the hip yaw that make_leg_geometry()
                        // refuses (leg.h)
    kBadCoupling = 16,  // a follower of a follower, of a joint that has another one, or with a wrong ratio
};

// Decodes and validates a model image (docs/reference/robot-model-format.md). On failure `model` is
// undefined. Cold, as all that runs at start-up only: compiled for size.
[[gnu::cold]] ModelStatus load_model(std::span<const std::byte> image, RobotModel& model);

// Limit for the distance of an anchor, centre of mass or sole edge from its frame: with 1 m, every chain of
// kMaxJoints stays within the range of Length.
inline constexpr fixed::Length kMaxOffset = fixed::Length::from_raw(1 << 24);
// Limits for the mass of a link and of the whole robot, base included. The sum of all links is at most 2^30
// LSB of Mass, which leaves a bit, and so is every partial sum. The sum of mass times coordinate in
// centre_of_mass() is at most 2^30 times the largest coordinate of a Length, 2^31, and fits 63 bits.
inline constexpr fixed::Mass kMaxLinkMass = fixed::Mass::from_raw(32 << 24);
inline constexpr fixed::Mass kMaxRobotMass = fixed::Mass::from_raw(64 << 24);

// Converts a joint angle to the position of its drive's shaft, rounded to nearest. Saturates at the range of
// the result, which matters for 31 position bits only.
[[nodiscard]] inline std::int32_t drive_position(const Drive& drive, fixed::Angle angle) {
  // A multiplication and a shift by a constant take half the instructions of a shift by a variable.
  constexpr int kSpare = 1;  // so that the product fits
  const std::int64_t shaft_raw = std::int64_t{drive.sign} * angle.raw() + drive.zero.raw();
  const std::int64_t scaled_raw =
      shaft_raw * std::int64_t{std::uint32_t{1} << (drive.position_bits - kSpare)};
  return fixed::saturate<std::int32_t>(
      fixed::shift_rounded(scaled_raw, fixed::Angle::kFractionBits - kSpare));
}
// Converts a position of the drive's shaft to the joint angle, exactly. Saturates at half a turn: an encoder
// just past a stop at 180 degrees must not seem to be at the opposite stop.
[[nodiscard]] fixed::Angle joint_angle(const Drive& drive, std::int32_t position);

// Returns the angle nearest to `angle` within the joint's limits.
[[nodiscard]] constexpr fixed::Angle clamp_to_limits(const Joint& joint, fixed::Angle angle) {
  return angle < joint.lower ? joint.lower : angle > joint.upper ? joint.upper : angle;
}

}  // namespace koboshi::robot
