// The numbers of telemetry and commands (docs/reference/object-dictionary.md, objects 2000 and 2001):
// recordings and other programs know no names.

#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <utility>

#include "firmware/behaviour/command.h"
#include "firmware/behaviour/state.h"
#include "firmware/drive/fault.h"

namespace koboshi::behaviour {
namespace {

template <typename T>
void expect_numbers(std::initializer_list<std::pair<T, int>> pairs) {
  for (const auto& [name, number] : pairs) EXPECT_EQ(static_cast<int>(name), number);
}

TEST(TelemetryNumbers, OfStates) {
  int number = 0;
  for (const char* name : {"boot", "limp", "enabling", "soft start", "standing", "motion", "fault",
                           "emergency stop", "walking", "low battery", "falling", "fallen", "righting",
                           "rolling", "rising", "steadying", "sitting down", "streaming"})
    EXPECT_EQ(kStates[number++].name, name);
  expect_numbers<State>({{State::kBoot, 0},
                         {State::kLimp, 1},
                         {State::kEnabling, 2},
                         {State::kSoftStart, 3},
                         {State::kStanding, 4},
                         {State::kMotion, 5},
                         {State::kFault, 6},
                         {State::kEmergencyStop, 7},
                         {State::kWalking, 8},
                         {State::kLowBattery, 9},
                         {State::kFalling, 10},
                         {State::kFallen, 11},
                         {State::kRighting, 12},
                         {State::kRolling, 13},
                         {State::kRising, 14},
                         {State::kSteadying, 15},
                         {State::kSittingDown, 16},
                         {State::kStreaming, 17}});
}

TEST(TelemetryNumbers, OfReasons) {
  using enum Reason;
  expect_numbers<Reason>({{kNone, 0},
                          {kCommand, 1},
                          {kProgress, 2},
                          {kSupplyLow, 3},
                          {kFallPredicted, 4},
                          {kRecoveryStepFailed, 5},
                          {kProne, 6},
                          {kSupine, 7},
                          {kOnLeftSide, 8},
                          {kOnRightSide, 9},
                          {kHeldUpright, 10},
                          {kCaughtItself, 11},
                          {kOnSeat, 12},
                          {kPushed, 13},
                          {kMotionFailed, 14},
                          {kModelInvalid, 16},
                          {kDriveFault, 17},
                          {kImuSilent, 18},
                          {kAnkleSilent, 19},
                          {kBusOff, 20},
                          {kNoAcknowledge, 21},
                          {kCannotGetUp, 22},
                          {kNotOperational, 23},
                          {kSecondMaster, 24},
                          {kNotInThisState, 32},
                          {kEncoderBeyondLimits, 33},
                          {kSupplyOutOfRange, 34},
                          {kImuImplausible, 35},
                          {kNoSuchMotion, 36},
                          {kUnknownCommand, 37},
                          {kDriveNotReady, 38},
                          {kVelocityOutOfRange, 39},
                          {kNotAtRest, 40},
                          {kNoGait, 41},
                          {kGyroBiasUnknown, 42},
                          {kJointsInUse, 43}});
}

TEST(TelemetryNumbers, OfCommandsAndDriveFaults) {
  expect_numbers<Command>({{Command::kNone, 0},
                           {Command::kEnable, 1},
                           {Command::kLimp, 2},
                           {Command::kPlay, 3},
                           {Command::kStop, 4},
                           {Command::kEmergencyStop, 5},
                           {Command::kReset, 6},
                           {Command::kWalk, 7},
                           {Command::kCalibrate, 8},
                           {Command::kGetUp, 9},
                           {Command::kStream, 10}});
  using drive::DriveFault;
  expect_numbers<DriveFault>({{DriveFault::kNone, 0},
                              {DriveFault::kSilent, 1},
                              {DriveFault::kNoAnswer, 2},
                              {DriveFault::kRefused, 3},
                              {DriveFault::kWrongIdentity, 4},
                              {DriveFault::kLost, 5},
                              {DriveFault::kRestarted, 6},
                              {DriveFault::kFault, 7},
                              {DriveFault::kNotEnabled, 8},
                              {DriveFault::kNotFollowing, 9}});
  EXPECT_EQ(drive::JointFault().joint, 0);
  EXPECT_EQ(drive::JointFault().error_code, 0);
}

// The set of each property, by the numbers of its states.
TEST(StateSets, HaveTheseStates) {
  const auto members = [](States states) {
    std::uint32_t bits = 0;
    for (unsigned number = 0; number < std::size(kStates); ++number)
      bits |= states.contains(static_cast<State>(number)) ? 1u << number : 0u;
    return bits;
  };
  constexpr std::uint32_t kFeet = 1u << 4 | 1u << 5 | 1u << 8 | 1u << 9 | 1u << 16 | 1u << 17;
  EXPECT_EQ(members(kOnItsFeet), kFeet);
  EXPECT_EQ(members(kBalancing), (kFeet & ~(1u << 17)) | 1u << 15);
  EXPECT_EQ(members(kMayFall), kFeet | 1u << 3 | 1u << 15);
  EXPECT_EQ(members(kTorque), kFeet | 1u << 2 | 1u << 3 | 1u << 10 | 0xFu << 12);
  EXPECT_EQ(members(kResting), 1u << 0 | 1u << 1 | 1u << 11);
  EXPECT_EQ(members(kMayStore), 1u << 1 | 1u << 4 | 1u << 5);
  EXPECT_EQ(members(kLatched), 1u << 6 | 1u << 7);
  EXPECT_EQ(members(kRecovering), 0x3Fu << 10);
  EXPECT_EQ(members(kGettingUp), 0xFu << 12);
  EXPECT_EQ(members(~kOnItsFeet), 0x3FFFFu & ~kFeet);
}

}  // namespace
}  // namespace koboshi::behaviour
