#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "firmware/app/calibration.h"
#include "firmware/app/factory_parameters.h"
#include "firmware/balance/feedback.h"
#include "firmware/behaviour/behaviour.h"
#include "firmware/behaviour/command.h"
#include "firmware/behaviour/parameters.h"
#include "firmware/behaviour/state.h"
#include "firmware/canopen/node/node.h"
#include "firmware/drive/fault.h"
#include "firmware/drive/signals.h"
#include "firmware/motion/motion_library.h"
#include "firmware/policy/policy.h"
#include "firmware/policy/residual.h"
#include "firmware/robot/model.h"
#include "firmware/walk/gait.h"
#include "firmware/walk/velocity.h"

namespace koboshi::app {

using behaviour::Command;
using behaviour::Event;
using behaviour::Reason;
using behaviour::State;

// Elements of a mask with a bit for each motion.
inline constexpr std::size_t kMotionMasks = std::tuple_size_v<motion::MotionLibrary::Mask>;

// Bits of object 0x1F80 (CiA 302-2).
inline constexpr std::uint32_t kNmtMaster = 1u << 0;       // always set
inline constexpr std::uint32_t kStartsTogether = 1u << 1;  // one NMT start for all nodes, not one for each
inline constexpr std::uint32_t kNoSelfStart = 1u << 2;     // another master starts the controller
inline constexpr std::uint32_t kNoSlaveStart = 1u << 3;    // another master starts drives and sensors
inline constexpr std::uint32_t kNmtStartupBits = kNmtMaster | kStartsTogether | kNoSelfStart | kNoSlaveStart;

// State of the learned controller of the walk.
enum class PolicyState : std::uint8_t {
  kOff = 0,      // not enabled
  kMissing = 1,  // enabled, but storage has none
  kRefused = 2,  // enabled, but the one in storage is not valid for this robot
  kReady = 3,    // waits for a walk
  kActive = 4,   // adds its offsets
  kStopped = 5,  // by its watchdog, until this walk has ended
};

// The values behind the controller's object dictionary. The initial values of the parameters are neutral: no
// feedback, no gait, no velocity, no fall detection. What the robot needs comes from its storage
// (app/factory_parameters.h).
struct ControllerValues {
  std::uint32_t nmt_startup = kNmtMaster;  // 0x1F80
  struct {
    Command command = Command::kNone;
    std::int16_t argument = 0;
  } request;  // 0x2000: RPDO 0 (identifier 0x201), or by SDO
  struct {
    State state = State::kBoot;
    Reason reason = Reason::kNone;
    std::uint8_t motion = 0;  // number of the motion being played or played last
    drive::DriveFault drive_fault = drive::DriveFault::kNone;
    std::uint8_t faulty_joint = 0;
    std::uint16_t drive_error_code = 0;
    std::uint16_t faults = 0;                              // since power-on; saturates
    Reason refusal = Reason::kNone;                        // of the last command; kNone when it was obeyed
    std::uint8_t attempts = 0;                             // to get up since the robot stood last
    std::uint8_t overlay = behaviour::Status::kNoOverlay;  // number of the second motion being played
  } behaviour;                                             // 0x2001
  struct {
    std::int16_t roll = 0;  // 2^-16 turn
    std::int16_t pitch = 0;
    std::int16_t rate[3] = {};          // 2^-12 turn/s, axes of the trunk
    std::int16_t acceleration[3] = {};  // 2^-8 m/s^2
  } attitude;                           // 0x2010
  struct {
    std::int16_t foot_zmp[2][2] = {};  // x, y of each foot in its sole's frame; 2^-15 m, as all lengths here
    std::int16_t zmp[2] = {};          // x, y of both feet, in the frame of the sole that carries more
    std::int16_t com[3] = {};          // centre of mass by the joints, in the same frame
    std::uint8_t flags = 0;            // kLeftZmpValid etc.; invalid values are zero
    std::int16_t planned_zmp[2] = {};  // x, y that a walk plans, in the frame of the sole that the flags tell
  } balance;                           // 0x2011
  struct {
    std::int16_t position[2] = {};  // x, y of the centre of mass; 2^-15 m
    std::int16_t velocity[2] = {};  // mm/s
    std::int16_t dcm[2] = {};       // 2^-15 m, as the next
    std::int16_t dcm_error[2] = {};
    std::uint8_t flags = 0;  // kComValid etc.
  } com;                     // 0x2012
  struct {
    std::uint16_t open_circuit_mV = 0;
    std::int16_t load_sag_mV = 0;
  } supply;  // 0x2013
  struct {
    std::int16_t position[2] = {};       // mm, as odometer; saturates
    std::int16_t heading = 0;            // 2^-16 turn
    std::uint8_t flags = 0;              // kGroundValid etc.
    std::int16_t slope[2] = {};          // 2^-16 turn
    std::int16_t attitude_zero[2] = {};  // 2^-16 turn
    std::uint16_t contact_ms[2] = {};    // by Side; since the last touchdown or lift-off; saturates
  } place;                               // 0x2014
  // 0x2020, 0x2021: force and torque in counts; FootSensor::kNoCount if they are not measured.
  std::int16_t ankles[2][6] = {};
  behaviour::PowerParameters parameters;   // 0x2100
  balance::FeedbackParameters feedback;    // 0x2101 to 0x2106
  walk::Velocity velocity;                 // 0x2110; always within its limits
  walk::VelocityLimits velocity_limits;    // 0x2111
  Calibration calibration;                 // 0x2120..0x2122
  walk::WalkParameters walk;               // 0x2130 to 0x2132
  behaviour::RecoveryParameters recovery;  // 0x2140 and 0x2141
  struct {
    std::uint8_t enabled = 0;
    PolicyState state = PolicyState::kOff;
    policy::Cause cause = policy::Cause::kNone;  // why the watchdog stopped it last
    std::uint8_t cause_number = 0;               // of that input or output
    std::uint16_t stops = 0;                     // since power-on; saturates
  } policy;                                      // 0x2150
  struct {
    std::uint8_t sequence = 0;                             // 0x2160; takes the set below
    std::uint16_t taken_sets = 0;                          // since power-on; saturates, as the next
    std::uint16_t missing_sets = 0;                        // by gaps in the sequence
    std::int16_t targets[robot::kMaxJoints] = {};          // 0x2161; 2^-16 turn, by joint
    std::uint8_t torques_percent[robot::kMaxJoints] = {};  // 0x2162; 0: full torque
  } stream;
  struct {
    std::uint32_t model_id = 0;
    std::uint32_t motions[kMotionMasks] = {};  // bit b of element i: motion 32 i + b is valid
    std::uint16_t frames_lost = 0;
    std::uint16_t imu_overruns = 0;
    std::uint16_t receive_overruns = 0;
    std::uint16_t gyro_calibrations = 0;  // seconds of rest that gave the gyro's bias; 0: unknown
    std::int16_t gyro_bias[3] = {};       // 2^-12 turn/s, axes of the trunk
    std::uint16_t falls = 0;              // since power-on; saturates, as the next
    std::uint16_t risen = 0;
    FactoryStatus factory_parameters = FactoryStatus::kNone;
    std::uint32_t without_torque_limit = 0;   // bit i: joint i's drive has refused it since the boot
    std::uint32_t without_position_gain = 0;  // likewise
  } diagnosis;                                // 0x2200, 0x2403
  std::uint16_t lost_abilities = 0;           // 0x2201; bit i: robot::Ability i
  drive::DriveSignals drives;                 // 0x2300..0x2304, by joint from sub-index 1
  struct {
    std::int16_t inputs[motion::kInputCount] = {};  // that motions read
  } motion;                                         // 0x2410
};

inline constexpr std::uint16_t kNmtStartupObject = 0x1F80;
inline constexpr std::uint16_t kRequestObject = 0x2000;
inline constexpr std::uint8_t kCommandSubindex = 1;  // of kRequestObject
inline constexpr std::uint16_t kVelocityObject = 0x2110;
inline constexpr std::uint16_t kVelocityLimitsObject = 0x2111;
inline constexpr std::uint16_t kTrimObject = 0x2120;
inline constexpr std::uint16_t kMountingObject = 0x2121;
inline constexpr std::uint16_t kGyroBiasObject = 0x2122;
// Motion n at sub-index n + 1.
inline constexpr std::uint16_t kMotionObject = 0x2400;
inline constexpr std::uint16_t kMotionNameObject = 0x2401;
inline constexpr std::uint16_t kMotionCrcObject = 0x2402;

inline constexpr std::uint16_t kFreeStorageObject = 0x2404;
inline constexpr std::uint16_t kMotionInputObject = 0x2410;  // input n at sub-index n + 1

inline constexpr std::uint16_t kPolicyParameterObject = 0x2150;
// The joint target stream: sequence counter, targets and torque limits.
inline constexpr std::uint16_t kStreamObject = 0x2160;
inline constexpr std::uint16_t kStreamTargetObject = 0x2161;
inline constexpr std::uint16_t kStreamTorqueObject = 0x2162;
inline constexpr std::uint16_t kPolicyObject = 0x2420;
inline constexpr std::uint16_t kPolicyNameObject = 0x2421;
inline constexpr std::uint16_t kPolicyCrcObject = 0x2422;

// Bits of the balance's flags: which ZMPs are valid, and whether the right sole is the frame of the measured
// and of the planned one.
inline constexpr std::uint8_t kLeftZmpValid = 1 << 0;
inline constexpr std::uint8_t kRightZmpValid = 1 << 1;
inline constexpr std::uint8_t kZmpValid = 1 << 2;
inline constexpr std::uint8_t kFrameIsRight = 1 << 3;
inline constexpr std::uint8_t kPlannedZmpValid = 1 << 4;
inline constexpr std::uint8_t kPlanIsInRight = 1 << 5;
// The feet that are in contact, on a robot that measures no ZMP; on any other the ZMP's validity says so.
inline constexpr std::uint8_t kLeftContact = 1 << 6;
inline constexpr std::uint8_t kRightContact = 1 << 7;

// Bits of the flags of 0x2012: the motion of the centre of mass is valid, in the frame of the right sole, and
// a walk has compared it with its plan; each foot bears load.
inline constexpr std::uint8_t kComValid = 1 << 0;
inline constexpr std::uint8_t kComIsInRight = 1 << 1;
inline constexpr std::uint8_t kDcmErrorValid = 1 << 2;
inline constexpr std::uint8_t kLeftTouches = 1 << 3;
inline constexpr std::uint8_t kRightTouches = 1 << 4;

// Bit of the flags of 0x2014.
inline constexpr std::uint8_t kGroundValid = 1 << 0;

// A length of 0x2011 that the robot does not measure.
inline constexpr std::int16_t kNoLength = std::numeric_limits<std::int16_t>::min();

// RPDO 0 (identifier 0x201) carries commands, RPDO 1 (0x301) the velocity, RPDO 2 (0x401) the first four
// inputs of motions, RPDO 3 + i the answers of joint i's drive; TPDO 0..9 carry telemetry, TPDO 10 + i
// controlword and target of joint i's drive.
inline constexpr std::size_t kCommandRpdo = 0;
inline constexpr std::size_t kVelocityRpdo = 1;
inline constexpr std::size_t kFirstDriveRpdo = 3;
// Behind those of the drives: the sequence counter of the joint target stream, four of its targets each, and
// eight of its torque limits each.
inline constexpr std::size_t kStreamRpdo = kFirstDriveRpdo + robot::kMaxJoints;
inline constexpr std::size_t kStreamTargetRpdos = (robot::kMaxJoints + 3) / 4;
inline constexpr std::size_t kStreamTorqueRpdos = (robot::kMaxJoints + 7) / 8;
inline constexpr std::size_t kRpdos = kStreamRpdo + 1 + kStreamTargetRpdos + kStreamTorqueRpdos;
inline constexpr std::size_t kTelemetryTpdos = 10;
inline constexpr std::size_t kFirstDriveTpdo = kTelemetryTpdos;

// The event timer of the velocity's RPDO (0x1401:5) after a reset: a walk ends when its velocity is not
// repeated within it. Five repetitions of a program that sends ten a second: four in a row may be lost. Set
// by hand (2026-11-25).
inline constexpr std::uint16_t kVelocityDeadline_ms = 500;

// COB-IDs of the joint target stream: targets of joints 4 i to 4 i + 3, torque limits of joints 8 i to 8 i +
// 7, and the sequence counter, which is last, so that it follows its set on the bus. The predefined
// connection set (CiA 301, 7.3.5) uses none of them, its annex reserves none of them, and they end before
// 0x690, where the second SDO channels of the drives begin; they give way to all traffic of the control
// cycle.
inline constexpr std::uint32_t kStreamTargetBase = 0x680;
inline constexpr std::uint32_t kStreamTorqueBase = kStreamTargetBase + kStreamTargetRpdos;
inline constexpr std::uint32_t kStreamSequenceIdentifier = kStreamTorqueBase + kStreamTorqueRpdos;
static_assert(kStreamSequenceIdentifier < 0x690);

// The event timer of the sequence counter's RPDO after a reset: the stream ends when its sets do not come
// within it. Ten sets of a program that sends one in each control cycle. Set by hand (2026-11-28); a pose
// that balances by itself survives it, a controller's robot does not survive much more.
inline constexpr std::uint16_t kStreamDeadline_ms = 100;

// TPDOs 7 to 9 would load the bus of a larger robot, whose sensors may be nodes of it, beyond 90 % (R028):
// there they are not in use until somebody configures them.
inline constexpr std::size_t kTpdosOfALargeRobot = 7;
inline constexpr std::size_t kMaxJointsWithAllTpdos = 25;

extern const canopen::NodeDescription kControllerNode;
// Returns the node of a robot's controller: kControllerNode, without TPDOs 7 to 9 on a large robot.
const canopen::NodeDescription& controller_node(const robot::RobotModel& model);

// The controller's PDOs of the model's drives after a reset: RPDO kFirstDriveRpdo + i has the answers of
// joint i's drive, TPDO kFirstDriveTpdo + i its commands. Those beyond the model's joints are not in use.
canopen::PdoConfiguration drive_pdo(canopen::PdoDirection direction, std::size_t number,
                                    const robot::RobotModel& model);
// The controller's RPDOs of the joint target stream after a reset, kStreamRpdo to kRpdos - 1. Those whose
// joints the model does not have are not in use.
canopen::PdoConfiguration stream_pdo(std::size_t number, const robot::RobotModel& model);
// Entry `number` (from 0) of the controller's 0x1016 after a reset: the heartbeat of joint `number`'s drive;
// 0 beyond the model's joints.
std::uint32_t drive_consumer(std::size_t number, const robot::RobotModel& model);

}  // namespace koboshi::app
