#pragma once

#include "firmware/app/dictionary.h"
#include "firmware/canopen/described_object.h"
#include "firmware/canopen/dictionary.h"
#include "firmware/storage/item.h"

// The controller's objects: from this table come the rows in flash, controller.eds, koboshi.dbc and the page
// docs/reference/object-dictionary.md (`koboshi dictionary write`).
namespace koboshi::app {

inline constexpr canopen::ValueName kCommandNames[] = {
    canopen::value_name(Command::kNone, "none"),
    canopen::value_name(Command::kEnable, "enable"),
    canopen::value_name(Command::kLimp, "limp"),
    canopen::value_name(Command::kPlay, "play"),
    canopen::value_name(Command::kStop, "stop"),
    canopen::value_name(Command::kEmergencyStop, "emergency stop"),
    canopen::value_name(Command::kReset, "reset"),
    canopen::value_name(Command::kWalk, "walk"),
    canopen::value_name(Command::kCalibrate, "calibrate"),
    canopen::value_name(Command::kGetUp, "get up"),
};

inline constexpr canopen::ValueName kStateNames[] = {
    canopen::value_name(State::kBoot, "boot"),
    canopen::value_name(State::kLimp, "limp"),
    canopen::value_name(State::kEnabling, "enabling"),
    canopen::value_name(State::kSoftStart, "soft start"),
    canopen::value_name(State::kStanding, "standing"),
    canopen::value_name(State::kMotion, "motion"),
    canopen::value_name(State::kFault, "fault"),
    canopen::value_name(State::kEmergencyStop, "emergency stop"),
    canopen::value_name(State::kWalking, "walking"),
    canopen::value_name(State::kLowBattery, "low battery"),
    canopen::value_name(State::kFalling, "falling"),
    canopen::value_name(State::kFallen, "fallen"),
    canopen::value_name(State::kRighting, "righting"),
    canopen::value_name(State::kRolling, "rolling"),
    canopen::value_name(State::kRising, "rising"),
    canopen::value_name(State::kSteadying, "steadying"),
};

inline constexpr canopen::ValueName kReasonNames[] = {
    canopen::value_name(Reason::kNone, "none"),
    canopen::value_name(Reason::kCommand, "command"),
    canopen::value_name(Reason::kProgress, "progress"),
    canopen::value_name(Reason::kSupplyLow, "supply low"),
    canopen::value_name(Reason::kFallForeseen, "fall foreseen"),
    canopen::value_name(Reason::kBodyElsewhere, "body elsewhere"),
    canopen::value_name(Reason::kProne, "prone"),
    canopen::value_name(Reason::kSupine, "supine"),
    canopen::value_name(Reason::kOnLeftSide, "on left side"),
    canopen::value_name(Reason::kOnRightSide, "on right side"),
    canopen::value_name(Reason::kHeldUpright, "upright"),
    canopen::value_name(Reason::kCaughtItself, "caught itself"),
    canopen::value_name(Reason::kOnSeat, "on seat"),
    canopen::value_name(Reason::kModelInvalid, "model invalid"),
    canopen::value_name(Reason::kDriveTrouble, "drive trouble"),
    canopen::value_name(Reason::kImuSilent, "IMU silent"),
    canopen::value_name(Reason::kAnkleSilent, "ankle sensor silent"),
    canopen::value_name(Reason::kBusOff, "bus-off"),
    canopen::value_name(Reason::kNoAcknowledge, "no acknowledge"),
    canopen::value_name(Reason::kCannotGetUp, "cannot get up"),
    canopen::value_name(Reason::kNotOperational, "not operational"),
    canopen::value_name(Reason::kSecondMaster, "second master"),
    canopen::value_name(Reason::kNotInThisState, "not in this state"),
    canopen::value_name(Reason::kEncoderBeyondLimits, "encoder beyond limits"),
    canopen::value_name(Reason::kSupplyOutOfRange, "supply out of range"),
    canopen::value_name(Reason::kImuImplausible, "IMU implausible"),
    canopen::value_name(Reason::kNoSuchMotion, "no such motion"),
    canopen::value_name(Reason::kUnknownCommand, "unknown command"),
    canopen::value_name(Reason::kDriveNotReady, "drive not ready"),
    canopen::value_name(Reason::kVelocityOutOfRange, "velocity out of range"),
    canopen::value_name(Reason::kNotAtRest, "not at rest"),
    canopen::value_name(Reason::kNoGait, "no gait"),
};

inline constexpr canopen::ValueName kFactoryStatusNames[] = {
    canopen::value_name(FactoryStatus::kLoaded, "loaded"),
    canopen::value_name(FactoryStatus::kNone, "none in storage"),
    canopen::value_name(FactoryStatus::kDamaged, "damaged"),
    canopen::value_name(FactoryStatus::kOtherModel, "for another robot model"),
    canopen::value_name(FactoryStatus::kRefused, "refused"),
};

inline constexpr canopen::ValueName kTroubleNames[] = {
    canopen::value_name(drive::Trouble::kNone, "none"),
    canopen::value_name(drive::Trouble::kSilent, "silent"),
    canopen::value_name(drive::Trouble::kNoAnswer, "no answer"),
    canopen::value_name(drive::Trouble::kRefused, "refused"),
    canopen::value_name(drive::Trouble::kWrongIdentity, "wrong identity"),
    canopen::value_name(drive::Trouble::kLost, "lost"),
    canopen::value_name(drive::Trouble::kRestarted, "restarted"),
    canopen::value_name(drive::Trouble::kFault, "fault"),
    canopen::value_name(drive::Trouble::kNotEnabled, "not enabled"),
    canopen::value_name(drive::Trouble::kNotFollowing, "not following"),
};

// Those of firmware/app/telemetry_units.h, and of the drives.
inline constexpr canopen::Unit kAngleUnit{"deg", 360, 1 << 16};
inline constexpr canopen::Unit kAngleBySpeedUnit{"deg s/m", 360, 1 << 16};
inline constexpr canopen::Unit kRateUnit{"deg/s", 360, 1 << 12};
inline constexpr canopen::Unit kBiasUnit{"deg/s", 360, 1 << 24};
inline constexpr canopen::Unit kAccelerationUnit{"m/s^2", 1, 1 << 8};
inline constexpr canopen::Unit kLengthUnit{"mm", 1000, 1 << 15};
inline constexpr canopen::Unit kGainUnit{"s", 1, 1 << 12};
inline constexpr canopen::Unit kLeanGainUnit{"%", 100, 1 << 12};
inline constexpr canopen::Unit kVoltageUnit{"mV"};
inline constexpr canopen::Unit kSpeedUnit{"mm/s"};
inline constexpr canopen::Unit kTurnUnit{"mrad/s"};
inline constexpr canopen::Unit kTimeUnit{"ms"};
inline constexpr canopen::Unit kShortLengthUnit{"mm", 1, 10};
inline constexpr canopen::Unit kShareUnit{"%", 1, 10};
inline constexpr canopen::Unit kSpeedUpUnit{"mm/s^2"};
inline constexpr canopen::Unit kTurnUpUnit{"mrad/s^2"};
inline constexpr canopen::Unit kBendUnit{"rad/m", 1, 1000};
inline constexpr canopen::Unit kForceUnit{"N", 1, 100};
inline constexpr canopen::Unit kShaftUnit{"deg", 360, 1 << canopen::cia402::kPositionUnitBits};
inline constexpr canopen::Unit kTorqueShareUnit{"%", 1, 10};
inline constexpr canopen::Unit kForceCount{.name = "N", .resolution = canopen::Resolution::kForce};
inline constexpr canopen::Unit kTorqueCount{.name = "N m", .resolution = canopen::Resolution::kTorque};

inline constexpr std::string_view kPlane[] = {"x", "y"};
inline constexpr std::string_view kFootZmps[] = {"left x", "left y", "right x", "right y"};

inline constexpr std::size_t kJoints = robot::kMaxJoints;
inline constexpr int kMaxGain = 4096;  // one second, and one
// No more than a robot of this size can be built to do; what this one does, the limits say.
inline constexpr int kMaxTrim = (10 << 16) / 360;      // 10 degrees
inline constexpr int kMaxMounting = (30 << 16) / 360;  // a unit put in askew; another way up is another model
inline constexpr int kMaxGyroBias = (40 << 24) / 360;  // 40 deg/s, twice that of an MPU-6050
inline constexpr std::string_view kFeedbackJoints[] = {"ankle pitch", "ankle roll", "hip roll", "knee",
                                                       "hip pitch"};
inline constexpr std::string_view kMountingAngles[] = {"roll", "pitch", "yaw"};
inline constexpr int kMaxSpeed_mm_per_s = 2'000;
inline constexpr int kMaxTurn_mrad_per_s = 6'000;
inline constexpr int kMaxLean = (90 << 16) / 360;

#define FIELD(member) KOBOSHI_FIELD(ControllerValues, member)
#define OBJECT(index, subindex, member, ...) canopen::object(index, subindex, FIELD(member), __VA_ARGS__)

using enum canopen::Access;
using enum canopen::Mappable;

inline constexpr canopen::DescribedObject kControllerObjects[] = {
    {OBJECT(kNmtStartupObject, 0, nmt_startup, kReadWrite),
     {.name = "NMT startup",
      .comment = "CiA 302-2. Bit 0: NMT master, always set; 1: start all nodes by one message, instead of "
                 "each drive "
                 "and sensor by its own; 2: the controller waits for NMT start after a reset; 3: another "
                 "master starts "
                 "drives and sensors. Bit 2 acts at the next reset, so save it."}},
    canopen::heading(kRequestObject, "Request",
                     "The command is what acts: by SDO, write the argument first."),
    {OBJECT(0x2000, 1, request.command, kReadWrite, kRpdo), {.name = "Command", .values = kCommandNames}},
    {OBJECT(0x2000, 2, request.argument, kReadWrite, kRpdo),
     {.name = "Argument", .comment = "Of play: the number of the motion."}},
    canopen::heading(0x2001, "Behaviour", "What the robot as a whole is doing, and why."),
    {OBJECT(0x2001, 1, behaviour.state, kReadOnly, kTpdo), {.name = "State", .values = kStateNames}},
    {OBJECT(0x2001, 2, behaviour.reason, kReadOnly, kTpdo),
     {.name = "Reason", .values = kReasonNames, .comment = "Why the state is what it is."}},
    {OBJECT(0x2001, 3, behaviour.motion, kReadOnly, kTpdo),
     {.name = "Motion", .comment = "Number of the motion being played or played last."}},
    {OBJECT(0x2001, 4, behaviour.trouble, kReadOnly, kTpdo),
     {.name = "Drive trouble", .values = kTroubleNames, .comment = "Why a drive cannot be used."}},
    {OBJECT(0x2001, 5, behaviour.trouble_joint, kReadOnly, kTpdo),
     {.name = "Trouble joint", .comment = "The joint of that drive, from 0."}},
    {OBJECT(0x2001, 6, behaviour.trouble_code, kReadOnly, kTpdo),
     {.name = "Trouble code",
      .values = canopen::kErrorCodeNames,
      .comment = "Of that drive's emergency message."}},
    {OBJECT(0x2001, 7, behaviour.faults, kReadOnly, kTpdo),
     {.name = "Faults", .comment = "Since power-on; saturates."}},
    {OBJECT(0x2001, 8, behaviour.refusal, kReadOnly, kTpdo),
     {.name = "Refusal", .values = kReasonNames, .comment = "Of the last command; none when it was obeyed."}},
    {OBJECT(0x2001, 9, behaviour.attempts, kReadOnly, kTpdo),
     {.name = "Attempts", .comment = "To get up, since the robot stood last."}},
    canopen::heading(0x2010, "Attitude",
                     "Of the trunk, and what the inertial unit measures, in the trunk's axes."),
    {OBJECT(0x2010, 1, attitude.roll, kReadOnly, kTpdo), {.name = "Roll", .unit = kAngleUnit}},
    {OBJECT(0x2010, 2, attitude.pitch, kReadOnly, kTpdo), {.name = "Pitch", .unit = kAngleUnit}},
    {OBJECT(0x2010, 3, attitude.rate[0], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "Rate", .unit = kRateUnit, .elements = canopen::kAxes}},
    {OBJECT(0x2010, 6, attitude.acceleration[0], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "Acceleration", .unit = kAccelerationUnit, .elements = canopen::kAxes}},
    canopen::heading(0x2011, "Balance", "Zero moment point and centre of mass; what is not valid is zero."),
    {OBJECT(0x2011, 1, balance.foot_zmp[0][0], kReadOnly, kTpdo).repeated(4, 2),
     {.name = "ZMP",
      .unit = kLengthUnit,
      .elements = kFootZmps,
      .comment = "Of each foot, in its sole's frame."}},
    {OBJECT(0x2011, 5, balance.zmp[0], kReadOnly, kTpdo).repeated(2, 2),
     {.name = "ZMP",
      .unit = kLengthUnit,
      .elements = kPlane,
      .comment = "Of both feet, in the frame of the sole that carries more."}},
    {OBJECT(0x2011, 7, balance.com[0], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "CoM",
      .unit = kLengthUnit,
      .elements = canopen::kAxes,
      .comment = "By the joints, in the same frame."}},
    {OBJECT(0x2011, 10, balance.flags, kReadOnly, kTpdo),
     {.name = "Balance flags",
      .comment = "Bit 0: the left foot's ZMP is valid; 1: the right's; 2: that of both; 3: the frame is the "
                 "right sole's."}},
    canopen::heading(0x2020, "Left ankle", "The wrench that the ground side exerts, in the sensor's frame."),
    {OBJECT(0x2020, 1, ankles[0][0], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "Left force", .unit = kForceCount, .elements = canopen::kAxes}},
    {OBJECT(0x2020, 4, ankles[0][3], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "Left torque", .unit = kTorqueCount, .elements = canopen::kAxes}},
    canopen::heading(0x2021, "Right ankle", "The wrench that the ground side exerts, in the sensor's frame."),
    {OBJECT(0x2021, 1, ankles[1][0], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "Right force", .unit = kForceCount, .elements = canopen::kAxes}},
    {OBJECT(0x2021, 4, ankles[1][3], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "Right torque", .unit = kTorqueCount, .elements = canopen::kAxes}},
    canopen::heading(0x2100, "Parameters"),
    {OBJECT(0x2100, 1, parameters.supply_min_mV, kReadWrite),
     {.name = "Lowest supply",
      .unit = kVoltageUnit,
      .comment = "With less the robot refuses to be enabled."}},
    {OBJECT(0x2100, 2, parameters.supply_max_mV, kReadWrite),
     {.name = "Highest supply",
      .unit = kVoltageUnit,
      .comment = "With more the robot refuses to be enabled."}},
    {OBJECT(0x2100, 3, parameters.ramp_rate, kReadWrite).within<std::int16_t>(68, 4096),
     {.name = "Ramp rate", .unit = kRateUnit, .comment = "Of every joint in the soft start."}},
    {OBJECT(0x2100, 4, parameters.supply_low_mV, kReadWrite),
     {.name = "Low supply",
      .unit = kVoltageUnit,
      .comment =
          "With less for two seconds the robot ends its motion or walk, and stands until it was limp."}},
    canopen::heading(0x2101, "Gyro feedback in motions",
                     "A joint is turned by its gain times the trunk's rate; 0 is off."),
    {OBJECT(0x2101, 1, feedback.motion.ankle_pitch, kReadWrite).within(-kMaxGain, kMaxGain),
     {.name = "Ankle pitch gain", .unit = kGainUnit}},
    {OBJECT(0x2101, 2, feedback.motion.ankle_roll, kReadWrite).within(-kMaxGain, kMaxGain),
     {.name = "Ankle roll gain", .unit = kGainUnit}},
    {OBJECT(0x2101, 3, feedback.motion.hip_roll, kReadWrite).within(-kMaxGain, kMaxGain),
     {.name = "Hip roll gain", .unit = kGainUnit}},
    {OBJECT(0x2101, 4, feedback.motion.knee, kReadWrite).within(-kMaxGain, kMaxGain),
     {.name = "Knee gain", .unit = kGainUnit}},
    {OBJECT(0x2101, 5, feedback.motion.hip_pitch, kReadWrite).within(-kMaxGain, kMaxGain),
     {.name = "Hip pitch gain", .unit = kGainUnit}},
    canopen::heading(0x2102, "Gyro feedback while standing"),
    {OBJECT(0x2102, 1, feedback.standing.rate.ankle_pitch, kReadWrite)
         .within(-kMaxGain, kMaxGain)
         .repeated(std::size(kFeedbackJoints), sizeof(std::int16_t)),
     {.name = "Standing gain", .unit = kGainUnit, .elements = kFeedbackJoints}},
    canopen::heading(0x2103, "Attitude feedback while standing",
                     "A joint is turned by its gain times the angle by which the trunk leans; 0 is off."),
    {OBJECT(0x2103, 1, feedback.standing.lean.ankle_pitch, kReadWrite)
         .within(-kMaxGain, kMaxGain)
         .repeated(std::size(kFeedbackJoints), sizeof(std::int16_t)),
     {.name = "Standing lean gain", .unit = kLeanGainUnit, .elements = kFeedbackJoints}},
    canopen::heading(0x2104, "Gyro feedback while walking"),
    {OBJECT(0x2104, 1, feedback.walking.rate.ankle_pitch, kReadWrite)
         .within(-kMaxGain, kMaxGain)
         .repeated(std::size(kFeedbackJoints), sizeof(std::int16_t)),
     {.name = "Walking gain", .unit = kGainUnit, .elements = kFeedbackJoints}},
    canopen::heading(0x2105, "Attitude feedback while walking",
                     "Of the angle by which the trunk leans more than planned."),
    {OBJECT(0x2105, 1, feedback.walking.lean.ankle_pitch, kReadWrite)
         .within(-kMaxGain, kMaxGain)
         .repeated(std::size(kFeedbackJoints), sizeof(std::int16_t)),
     {.name = "Walking lean gain", .unit = kLeanGainUnit, .elements = kFeedbackJoints}},
    canopen::heading(
        0x2106, "Quiet standing",
        "Backlash and a quick feedback make a robot that sways for good; a slow sway is left alone."),
    {OBJECT(0x2106, 1, feedback.standing_dead_band, kReadWrite).within(0, 4096),
     {.name = "Standing dead band",
      .unit = kRateUnit,
      .comment = "What the gyro feedback while standing takes off the trunk's rate."}},
    canopen::heading(kVelocityObject, "Velocity", "The velocity to walk with, in the trunk's axes."),
    {OBJECT(kVelocityObject, 1, velocity.forward_mm_per_s, kReadWrite, kBoth),
     {.name = "Velocity forward", .unit = kSpeedUnit}},
    {OBJECT(kVelocityObject, 2, velocity.left_mm_per_s, kReadWrite, kBoth),
     {.name = "Velocity left", .unit = kSpeedUnit}},
    {OBJECT(kVelocityObject, 3, velocity.turn_mrad_per_s, kReadWrite, kBoth),
     {.name = "Velocity turn", .unit = kTurnUnit, .comment = "Counter-clockwise."}},
    canopen::heading(kVelocityLimitsObject, "Velocity limits",
                     "A velocity beyond them is refused; one in force is reduced to them."),
    {OBJECT(kVelocityLimitsObject, 1, velocity_limits.forward_mm_per_s, kReadWrite)
         .within(0, kMaxSpeed_mm_per_s),
     {.name = "Highest velocity forward", .unit = kSpeedUnit}},
    {OBJECT(kVelocityLimitsObject, 2, velocity_limits.backward_mm_per_s, kReadWrite)
         .within(0, kMaxSpeed_mm_per_s),
     {.name = "Highest velocity backward", .unit = kSpeedUnit}},
    {OBJECT(kVelocityLimitsObject, 3, velocity_limits.lateral_mm_per_s, kReadWrite)
         .within(0, kMaxSpeed_mm_per_s),
     {.name = "Highest velocity lateral", .unit = kSpeedUnit}},
    {OBJECT(kVelocityLimitsObject, 4, velocity_limits.turn_mrad_per_s, kReadWrite)
         .within(0, kMaxTurn_mrad_per_s),
     {.name = "Highest turn", .unit = kTurnUnit}},
    canopen::heading(kTrimObject, "Trims",
                     "Added to each joint's commanded angle, and taken from its measured one."),
    {OBJECT(kTrimObject, 1, calibration.trims[0], kReadWrite)
         .within(-kMaxTrim, kMaxTrim)
         .repeated(kJoints, sizeof(std::int16_t)),
     {.name = "Trim of joint",
      .unit = kAngleUnit,
      .comment = "The limits that the drive itself watches follow with its next boot."}},
    canopen::heading(kMountingObject, "Mounting of the inertial unit",
                     "About the trunk's axes, on top of the model's; written only while the robot is limp."),
    {OBJECT(kMountingObject, 1, calibration.mounting[0], kReadWrite)
         .within(-kMaxMounting, kMaxMounting)
         .repeated(3, sizeof(std::int16_t)),
     {.name = "Mounting", .unit = kAngleUnit, .elements = kMountingAngles}},
    canopen::heading(kGyroBiasObject, "Gyro bias at rest",
                     "Used until the robot has rested for a second; written only while it is limp."),
    {OBJECT(kGyroBiasObject, 1, calibration.gyro_bias[0], kReadWrite)
         .within(-kMaxGyroBias, kMaxGyroBias)
         .repeated(3, sizeof(std::int32_t)),
     {.name = "Known gyro bias", .unit = kBiasUnit, .elements = canopen::kAxes}},
    canopen::heading(
        0x2130, "Steps",
        "How the robot walks; in force when it begins to walk the next time. Without a gait it does not."),
    {OBJECT(0x2130, 1, walk.step.time_ms, kReadWrite).within(100, 600),
     {.name = "Step time", .unit = kTimeUnit, .comment = "Cut down to whole cycles of 10 ms."}},
    {OBJECT(0x2130, 2, walk.step.double_support, kReadWrite).within(0, 500),
     {.name = "Double support", .unit = kShareUnit, .comment = "Share of a step in double support."}},
    {OBJECT(0x2130, 3, walk.step.width, kReadWrite).within(400, 1500),
     {.name = "Step width", .unit = kShortLengthUnit, .comment = "Between the middle lines of the soles."}},
    {OBJECT(0x2130, 4, walk.step.height, kReadWrite).within(0, 600),
     {.name = "Step height", .unit = kShortLengthUnit, .comment = "Of the swing foot."}},
    {OBJECT(0x2130, 5, walk.step.swing_profile, kReadWrite).within(0, 1000),
     {.name = "Swing profile",
      .unit = kShareUnit,
      .comment = "100: the swing foot starts and lands without speed, a cycloid; 0: its speed is constant."}},
    {OBJECT(0x2130, 6, walk.step.acceleration[0], kReadWrite).within(10, 5000),
     {.name = "Acceleration forward", .unit = kSpeedUpUnit}},
    {OBJECT(0x2130, 7, walk.step.acceleration[1], kReadWrite).within(10, 5000),
     {.name = "Acceleration lateral", .unit = kSpeedUpUnit}},
    {OBJECT(0x2130, 8, walk.step.acceleration[2], kReadWrite).within(10, 20000),
     {.name = "Acceleration turn", .unit = kTurnUpUnit}},
    {OBJECT(0x2130, 9, walk.step.max_forward, kReadWrite).within(1, 5000),
     {.name = "Longest step",
      .unit = kShortLengthUnit,
      .comment = "Limit of the swing foot's landing position in front of and behind the support foot."}},
    {OBJECT(0x2130, 10, walk.step.max_lateral, kReadWrite).within(1, 5000),
     {.name = "Widest step",
      .unit = kShortLengthUnit,
      .comment = "Limit of the swing foot's landing position beside the support foot."}},
    {OBJECT(0x2130, 11, walk.step.min_lateral, kReadWrite).within(1, 5000),
     {.name = "Narrowest step",
      .unit = kShortLengthUnit,
      .comment = "Lower limit of the same: with less the soles would touch."}},
    canopen::heading(0x2131, "Walking posture", "In force when the robot begins to walk the next time."),
    {OBJECT(0x2131, 1, walk.posture.com_height, kReadWrite).within(500, 10000),
     {.name = "CoM height",
      .unit = kShortLengthUnit,
      .comment = "Of the centre of mass above the soles: the length of the pendulum."}},
    {OBJECT(0x2131, 2, walk.posture.zmp_forward, kReadWrite).within(-500, 500),
     {.name = "ZMP forward",
      .unit = kShortLengthUnit,
      .comment = "Of the planned ZMP, in front of the ankle."}},
    {OBJECT(0x2131, 3, walk.posture.zmp_inward, kReadWrite).within(-200, 200),
     {.name = "ZMP inward",
      .unit = kShortLengthUnit,
      .comment = "Of the planned ZMP, from the sole's middle line towards the other foot."}},
    {OBJECT(0x2131, 4, walk.posture.trunk_pitch, kReadWrite).within(-4096, 4096),
     {.name = "Trunk pitch", .unit = kAngleUnit, .comment = "Forward lean."}},
    {OBJECT(0x2131, 5, walk.posture.trunk_pitch_by_speed, kReadWrite).within(-16384, 16384),
     {.name = "Trunk pitch by speed",
      .unit = kAngleBySpeedUnit,
      .comment = "More forward lean for each m/s forward."}},
    {OBJECT(0x2131, 6, walk.posture.pitch_compliance, kReadWrite).within(0, 1900),
     {.name = "Pitch compliance",
      .unit = kBendUnit,
      .comment = "Sag of hip, knee and ankle under the robot's weight, that targets make up for."}},
    {OBJECT(0x2131, 7, walk.posture.roll_compliance, kReadWrite).within(0, 1900),
     {.name = "Roll compliance", .unit = kBendUnit, .comment = "The same of hip and ankle to the side."}},
    {OBJECT(0x2131, 8, walk.posture.arm_swing, kReadWrite).within(-1900, 1900),
     {.name = "Arm swing",
      .unit = kBendUnit,
      .comment = "Of a shoulder, by how far the foot of the other side is in front."}},
    canopen::heading(0x2132, "Walking reactions", "In force when the robot begins to walk the next time."),
    {OBJECT(0x2132, 1, walk.reaction.capture_forward, kReadWrite).within(0, 1500),
     {.name = "Capture forward",
      .unit = kShareUnit,
      .comment = "Share of the measured DCM error by which the next foothold moves."}},
    {OBJECT(0x2132, 2, walk.reaction.capture_lateral, kReadWrite).within(0, 1500),
     {.name = "Capture lateral", .unit = kShareUnit, .comment = "The same to the side."}},
    {OBJECT(0x2132, 3, walk.reaction.dead_band, kReadWrite).within(0, 1000),
     {.name = "Capture dead band", .unit = kShortLengthUnit, .comment = "Of the DCM error."}},
    {OBJECT(0x2132, 4, walk.reaction.smoothing, kReadWrite).within(0, 990),
     {.name = "Capture smoothing",
      .unit = kShareUnit,
      .comment = "Share of the last cycle's DCM error that is kept."}},
    {OBJECT(0x2132, 5, walk.reaction.touchdown_load_cN, kReadWrite).within(0, 5000),
     {.name = "Touchdown load",
      .unit = kForceUnit,
      .comment = "On the swing foot, which ends a step before its time; 0: no load does."}},
    {OBJECT(0x2132, 6, walk.reaction.heading_hold, kReadWrite).within(0, 1000),
     {.name = "Heading hold",
      .unit = kShareUnit,
      .comment = "Share of the heading error by which a step turns back; 0: off."}},
    canopen::heading(0x2140, "Fall detection",
                     "A fall is detected when the predicted lean leaves an ellipse."),
    {OBJECT(0x2140, 1, recovery.fall.front, kReadWrite).within(0, kMaxLean),
     {.name = "Fall to the front",
      .unit = kAngleUnit,
      .comment = "0, or any other limit not set: falls are not detected."}},
    {OBJECT(0x2140, 2, recovery.fall.back, kReadWrite).within(1, kMaxLean),
     {.name = "Fall to the back", .unit = kAngleUnit}},
    {OBJECT(0x2140, 3, recovery.fall.side, kReadWrite).within(1, kMaxLean),
     {.name = "Fall to the side", .unit = kAngleUnit}},
    {OBJECT(0x2140, 4, recovery.fall.lead_ms, kReadWrite).within(0, 500),
     {.name = "Fall lead", .unit = kTimeUnit, .comment = "How far ahead the lean is predicted."}},
    {OBJECT(0x2140, 5, recovery.fall.min_lean, kReadWrite).within(1, kMaxLean),
     {.name = "Smallest lean of a fall",
      .unit = kAngleUnit,
      .comment = "Of the present lean: with less, no rate makes a fall."}},
    {OBJECT(0x2140, 6, recovery.fall.cycles, kReadWrite).within(1, 100),
     {.name = "Cycles of a fall", .comment = "Of 10 ms, in a row."}},
    canopen::heading(0x2141, "Getting up"),
    {OBJECT(0x2141, 1, recovery.getting_up.attempts, kReadWrite).within(0, 20),
     {.name = "Attempts to get up", .comment = "0: a robot that fell stays down, in fault."}},
    {OBJECT(0x2141, 2, recovery.getting_up.slower, kReadWrite).within(0, 50),
     {.name = "Slower attempts",
      .unit = {"%"},
      .comment = "Of the first one's pace, which each further attempt has less; never below 30 %."}},
    canopen::heading(0x2200, "Diagnosis", "Counters saturate."),
    {OBJECT(0x2200, 1, diagnosis.model_id, kReadOnly),
     {.name = "Model id", .comment = "Of the robot model in storage."}},
    {OBJECT(0x2200, 2, diagnosis.motions, kReadOnly),
     {.name = "Motions", .comment = "Bit n: motion n in storage is valid."}},
    {OBJECT(0x2200, 3, diagnosis.frames_lost, kReadOnly),
     {.name = "Frames lost", .comment = "That found no room to be sent."}},
    {OBJECT(0x2200, 4, diagnosis.imu_overruns, kReadOnly),
     {.name = "IMU overruns", .comment = "Samples of the inertial unit that nobody read in time."}},
    {OBJECT(0x2200, 5, diagnosis.receive_overruns, kReadOnly),
     {.name = "Receive overruns", .comment = "Frames lost because the receive ring was full."}},
    {OBJECT(0x2200, 6, diagnosis.gyro_calibrations, kReadOnly),
     {.name = "Gyro calibrations",
      .unit = {"s"},
      .comment = "Seconds of rest that gave the gyro's bias; 0: it is not known."}},
    {OBJECT(0x2200, 7, diagnosis.gyro_bias[0], kReadOnly).repeated(3, 2),
     {.name = "Gyro bias", .unit = kRateUnit, .elements = canopen::kAxes, .comment = "In the trunk's axes."}},
    {OBJECT(0x2200, 10, diagnosis.falls, kReadOnly),
     {.name = "Falls", .comment = "That were foreseen, since power-on."}},
    {OBJECT(0x2200, 11, diagnosis.risen, kReadOnly),
     {.name = "Risen", .comment = "How often the robot got up, since power-on."}},
    {OBJECT(0x2200, 12, diagnosis.factory_parameters, kReadOnly),
     {.name = "Factory parameters",
      .values = kFactoryStatusNames,
      .comment = "Those of this robot in storage. Unless they are loaded, all parameters are neutral."}},
    // What goes to and comes from the drives, in their own words, by joint.
    canopen::heading(0x2300, "Drive controlwords"),
    {OBJECT(0x2300, 1, drives.controlword[0], kReadOnly, kTpdo).repeated(kJoints, 2),
     {.name = "Controlword of joint", .values = canopen::cia402::kControlwordNames}},
    canopen::heading(0x2301, "Drive target positions"),
    {OBJECT(0x2301, 1, drives.target_position[0], kReadOnly, kTpdo).repeated(kJoints, 4),
     {.name = "Target position of joint", .unit = kShaftUnit}},
    // What arrives in PDOs must be writable for them; by SDO it would be overwritten in the next cycle.
    canopen::heading(0x2302, "Drive statuswords"),
    {OBJECT(0x2302, 1, drives.statusword[0], kReadWrite, kRpdo).repeated(kJoints, 2),
     {.name = "Statusword of joint", .values = canopen::cia402::kStatuswordNames}},
    canopen::heading(0x2303, "Drive positions"),
    {OBJECT(0x2303, 1, drives.position[0], kReadWrite, kRpdo).repeated(kJoints, 4),
     {.name = "Position of joint", .unit = kShaftUnit}},
    canopen::heading(0x2304, "Drive torques"),
    {OBJECT(0x2304, 1, drives.torque_permille[0], kReadWrite, kRpdo).repeated(kJoints, 2),
     {.name = "Torque of joint", .unit = kTorqueShareUnit, .comment = "Of the drive's rated torque."}},
    canopen::heading(kMotionObject, "Motion images",
                     "Motion n at sub-index n + 1; kept in storage once it is complete and valid."),
    {canopen::domain(kMotionObject, 1, kReadWrite).repeated(storage::kMaxMotions, 0),
     {.name = "Image of motion", .comment = "Written only while the robot stands or is limp."}},
};
static_assert(canopen::is_described(kControllerObjects));

#undef OBJECT
#undef FIELD

}  // namespace koboshi::app
