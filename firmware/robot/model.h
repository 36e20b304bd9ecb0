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
#include "hal/port/side.h"

namespace koboshi::robot {

inline constexpr std::size_t kMaxJoints = 24;
inline constexpr std::size_t kModelNameSize = 24;
inline constexpr std::uint32_t kModelMagic = 0x444D524Bu;  // "KRMD"
inline constexpr std::uint16_t kModelVersion = 1;

// What a joint does in the body, so that code which needs a certain joint finds it on any robot.
// The legs and arms of both sides are in the same order.
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

// The servo drive of a joint: its shaft turns by sign * joint angle + zero, in units of 2^-position_bits
// turn.
struct Drive {
  std::uint8_t node_id = 0;
  std::int8_t sign = 1;
  std::uint8_t position_bits = 20;
  fixed::Angle zero;
  std::uint32_t vendor_id = 0;  // identity that object 0x1018 must show
  std::uint32_t product_code = 0;
  std::uint32_t serial_number = 0;
};

// A hinge and the link that it carries. The link's frame lies in the hinge's anchor; at joint zero its axes
// are those of B.
struct Joint {
  JointRole role = JointRole::kOther;
  LinkIndex parent;             // on which the hinge is mounted
  JointIndex mirror;            // joint of the other side; itself for one in the middle
  std::int8_t mirror_sign = 1;  // angle of the mirror image = sign * angle
  Position anchor;              // from the parent's anchor, or from B's origin
  Direction axis = kAxisZ;      // unit vector
  fixed::Angle lower;
  fixed::Angle upper;
  fixed::AngularRate max_speed;
  Drive drive;
  fixed::Mass mass;         // of the link
  Position centre_of_mass;  // in the link's frame
};

// The sole frame (L, R) lies below the ankle at joint zero, on the ground, with the foot's axes. This is the
// rectangle that touches the ground there, and the force/torque sensor, whose axes are the foot's.
struct Foot {
  fixed::Length ankle_height;  // of the ankle's axes above the sole
  fixed::Length back;          // x of the heel, negative
  fixed::Length front;
  fixed::Length right;  // y of the edge, negative
  fixed::Length left;
  Position sensor;  // in the sole frame; z is d of the paper's equation 1
};

// What a full-scale count of 2^15 means.
struct SensorScales {
  fixed::AngularRate gyro;
  fixed::Acceleration accelerometer;
  fixed::Force ankle_force;
  fixed::Torque ankle_torque;
};

// Which robot the firmware is on. Read from an image; only its calibration changes the drives' zeros and
// R_BI.
struct RobotModel {
  std::uint32_t id = 0;                     // the image's CRC-32: motions are bound to it
  std::array<char, kModelNameSize> name{};  // padded with zeros
  std::size_t joint_count = 0;
  std::array<Joint, kMaxJoints> joints{};
  std::array<JointIndex, kMaxJoints> order{};  // each joint after the one that carries its parent
  fixed::Mass base_mass;
  Position base_centre_of_mass;  // in B
  fixed::Length body_height;     // from sole to crown at joint zero
  Rotation R_BI;                 // inertial unit I
  SensorScales scales;
  hal::BySide<Foot> feet{};

  // Returns the joint with this role, the first one; nothing where the robot has none.
  [[nodiscard]] std::optional<JointIndex> find(JointRole role) const;
  // Hip yaw, roll, pitch, knee, ankle pitch, roll. A loaded model has them.
  [[nodiscard]] std::array<JointIndex, kLegJoints> leg(hal::Side side) const;
};

enum class [[nodiscard]] ModelStatus : std::uint8_t{
    kOk = 0,
    kTruncated = 1,  // up to kBadCrc as storage::ImageStatus
    kBadMagic = 2,
    kBadVersion = 3,
    kBadSize = 4,
    kBadCrc = 5,
    kBadJointCount = 6,  // 0, or more than kMaxJoints
    kBadField = 7,       // a sign, role, node id, index or unit with a value that has no meaning
    kOutOfRange = 8,     // a length, mass, speed or scale that no such robot has
    kNotARotation = 9,   // an axis that is no unit vector, or an inertial unit's matrix that is no rotation
    kLimitsReversed = 10,
    kCyclicTree = 11,
    kDuplicateNodeId = 12,
    kDuplicateRole = 13,
    kBadMirror = 14,  // the mirror image of a joint's mirror image is not the joint
    kBadLeg = 15,     // a missing leg joint, or axes that the closed-form inverse kinematics cannot serve
};

// Decodes and validates. On failure `model` is left half-written and must not be used.
ModelStatus load_model(std::span<const std::byte> image, RobotModel& model);

// Longest distance of an anchor, centre of mass or sole edge from its frame: 1 m keeps every chain of
// kMaxJoints within Length.
inline constexpr fixed::Length kMaxOffset = fixed::Length::from_raw(1 << 24);
// Largest mass of a link: 5 kg keep the sum of the base's and kMaxJoints links' within Mass.
inline constexpr fixed::Mass kMaxLinkMass = fixed::Mass::from_raw(5 << 24);

// Target or actual position of the drive's shaft for a joint angle, and back. Rounded to nearest; an angle
// beyond half a turn saturates, so that an encoder just past a stop at 180 degrees does not seem to be at the
// other stop.
[[nodiscard]] inline std::int32_t drive_position(const Drive& drive, fixed::Angle angle) {
  // A multiplication and a shift by a constant take half the instructions of a shift by a variable.
  constexpr int kSpare = 1;  // so that the product fits
  const std::int64_t shaft_raw = std::int64_t{drive.sign} * angle.raw() + drive.zero.raw();
  const std::int64_t scaled_raw =
      shaft_raw * std::int64_t{std::uint32_t{1} << (drive.position_bits - kSpare)};
  return fixed::saturate<std::int32_t>(
      fixed::shift_rounded(scaled_raw, fixed::Angle::kFractionBits - kSpare));
}
[[nodiscard]] fixed::Angle joint_angle(const Drive& drive, std::int32_t position);

[[nodiscard]] constexpr fixed::Angle clamp_to_limits(const Joint& joint, fixed::Angle angle) {
  return angle < joint.lower ? joint.lower : angle > joint.upper ? joint.upper : angle;
}

}  // namespace koboshi::robot
