#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <string_view>

#include "firmware/app/dictionary.h"
#include "firmware/behaviour/state.h"
#include "firmware/canopen/cia402.h"
#include "firmware/canopen/described_object.h"

// Names of values, units and limits for the table of the controller's objects (controller_objects.h).
namespace koboshi::app {

// When a written parameter takes effect, unless at once.
inline constexpr std::string_view kWithinTwoSteps = "within two steps";
inline constexpr std::string_view kAtNextSoftStart = "at the next soft start";
inline constexpr std::string_view kAtNextAttempt = "at the next attempt to get up";
inline constexpr std::string_view kOnlyWhileLimp = "at once, refused unless limp";

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
    canopen::value_name(Command::kStream, "stream"),
};

inline constexpr auto kStateNames = [] {
  std::array<canopen::ValueName, std::size(behaviour::kStates)> names{};
  for (std::size_t i = 0; i < names.size(); ++i)
    names[i] = canopen::value_name(behaviour::kStates[i].state, behaviour::kStates[i].name);
  return names;
}();

inline constexpr canopen::ValueName kReasonNames[] = {
    canopen::value_name(Reason::kNone, "none"),
    canopen::value_name(Reason::kCommand, "command"),
    canopen::value_name(Reason::kProgress, "progress"),
    canopen::value_name(Reason::kSupplyLow, "supply low"),
    canopen::value_name(Reason::kFallPredicted, "fall predicted"),
    canopen::value_name(Reason::kRecoveryStepFailed, "recovery step failed"),
    canopen::value_name(Reason::kProne, "prone"),
    canopen::value_name(Reason::kSupine, "supine"),
    canopen::value_name(Reason::kOnLeftSide, "on left side"),
    canopen::value_name(Reason::kOnRightSide, "on right side"),
    canopen::value_name(Reason::kHeldUpright, "upright"),
    canopen::value_name(Reason::kCaughtItself, "caught itself"),
    canopen::value_name(Reason::kOnSeat, "on seat"),
    canopen::value_name(Reason::kPushed, "pushed"),
    canopen::value_name(Reason::kMotionFailed, "motion failed"),
    canopen::value_name(Reason::kModelInvalid, "model invalid"),
    canopen::value_name(Reason::kDriveFault, "drive fault"),
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
    canopen::value_name(Reason::kNoLegs, "no legs to walk"),
    canopen::value_name(Reason::kGyroBiasUnknown, "gyro bias unknown"),
    canopen::value_name(Reason::kJointsInUse, "joints in use"),
};

inline constexpr canopen::ValueName kFactoryStatusNames[] = {
    canopen::value_name(FactoryStatus::kLoaded, "loaded"),
    canopen::value_name(FactoryStatus::kNone, "none in storage"),
    canopen::value_name(FactoryStatus::kDamaged, "damaged"),
    canopen::value_name(FactoryStatus::kOtherModel, "for another robot model"),
    canopen::value_name(FactoryStatus::kRefused, "refused"),
};

inline constexpr canopen::ValueName kPolicyStateNames[] = {
    canopen::value_name(PolicyState::kOff, "off"),
    canopen::value_name(PolicyState::kMissing, "none in storage"),
    canopen::value_name(PolicyState::kRefused, "refused"),
    canopen::value_name(PolicyState::kReady, "ready"),
    canopen::value_name(PolicyState::kActive, "active"),
    canopen::value_name(PolicyState::kStopped, "stopped"),
};

inline constexpr canopen::ValueName kPolicyCauseNames[] = {
    canopen::value_name(policy::Cause::kNone, "none"),
    canopen::value_name(policy::Cause::kInputOutOfRange, "input out of range"),
    canopen::value_name(policy::Cause::kOutputOutOfRange, "output out of range"),
};

inline constexpr canopen::ValueName kPolicyStatusNames[] = {
    canopen::value_name(policy::PolicyStatus::kOk, "valid"),
    canopen::value_name(policy::PolicyStatus::kTruncated, "none"),
    canopen::value_name(policy::PolicyStatus::kBadMagic, "no policy"),
    canopen::value_name(policy::PolicyStatus::kBadVersion, "another version"),
    canopen::value_name(policy::PolicyStatus::kBadSize, "size"),
    canopen::value_name(policy::PolicyStatus::kBadCrc, "CRC"),
    canopen::value_name(policy::PolicyStatus::kOtherRobot, "for another robot"),
    canopen::value_name(policy::PolicyStatus::kBadCount, "count"),
    canopen::value_name(policy::PolicyStatus::kBadName, "name"),
    canopen::value_name(policy::PolicyStatus::kBadInput, "input"),
    canopen::value_name(policy::PolicyStatus::kBadOutput, "output"),
    canopen::value_name(policy::PolicyStatus::kBadLayer, "layer"),
    canopen::value_name(policy::PolicyStatus::kBadBias, "bias"),
    canopen::value_name(policy::PolicyStatus::kTooMuchWork, "too much work"),
    canopen::value_name(policy::PolicyStatus::kMisaligned, "misaligned"),
};

inline constexpr canopen::ValueName kDriveFaultNames[] = {
    canopen::value_name(drive::DriveFault::kNone, "none"),
    canopen::value_name(drive::DriveFault::kSilent, "silent"),
    canopen::value_name(drive::DriveFault::kNoAnswer, "no answer"),
    canopen::value_name(drive::DriveFault::kRefused, "refused"),
    canopen::value_name(drive::DriveFault::kWrongIdentity, "wrong identity"),
    canopen::value_name(drive::DriveFault::kLost, "lost"),
    canopen::value_name(drive::DriveFault::kRestarted, "restarted"),
    canopen::value_name(drive::DriveFault::kFault, "fault"),
    canopen::value_name(drive::DriveFault::kNotEnabled, "not enabled"),
    canopen::value_name(drive::DriveFault::kNotFollowing, "not following"),
};

// Units of the objects: those of telemetry_units.h, of parameters and of the drives.
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
inline constexpr canopen::Unit kAngleByErrorUnit{"rad/m", 1, 100};
inline constexpr canopen::Unit kForceUnit{"N", 1, 100};
inline constexpr canopen::Unit kShaftUnit{"deg", 360, 1 << canopen::cia402::kPositionUnitBits};
inline constexpr canopen::Unit kTorqueShareUnit{"%", 1, 10};
inline constexpr canopen::Unit kForceCount{.name = "N", .resolution = canopen::Resolution::kForce};
inline constexpr canopen::Unit kTorqueCount{.name = "N m", .resolution = canopen::Resolution::kTorque};

inline constexpr std::string_view kAnkleComment =
    "The wrench that the ground side exerts: of a six-axis sensor in its frame, of pressure cells about the "
    "sole's origin. -32768: not measured.";
inline constexpr std::string_view kPlane[] = {"x", "y"};
inline constexpr std::string_view kSides[] = {"left", "right"};
inline constexpr std::string_view kFootZmps[] = {"left x", "left y", "right x", "right y"};

inline constexpr std::size_t kJoints = robot::kMaxJoints;
inline constexpr int kMaxGain = 4096;  // one second, and one
// Highest values of parameters: beyond what a robot of this size can do, so that a typing error is refused.
inline constexpr int kMaxTrim = (10 << 16) / 360;      // 10 degrees
inline constexpr int kMaxMounting = (30 << 16) / 360;  // 30 degrees; other orientations belong to the model
inline constexpr int kMaxGyroBias = (40 << 24) / 360;  // 40 deg/s, twice the zero-rate output of an MPU-6050
inline constexpr std::string_view kFeedbackJoints[] = {"ankle pitch", "ankle roll", "hip roll", "knee",
                                                       "hip pitch"};
inline constexpr std::string_view kMountingAngles[] = {"roll", "pitch", "yaw"};
inline constexpr int kMaxSpeed_mm_per_s = 2'000;
inline constexpr int kMaxTurn_mrad_per_s = 6'000;
inline constexpr int kMaxLean = (90 << 16) / 360;

}  // namespace koboshi::app
