// The numbers that the standards give: a node and a tool of another maker know no names. Both sides of this
// repository's own tests would agree on a wrong one.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <initializer_list>
#include <utility>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/emergency.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/lss_slave.h"
#include "firmware/canopen/node/node.h"
#include "firmware/canopen/sdo/protocol.h"

namespace koboshi::canopen {
namespace {

// Expects each name to have the number beside it.
template <typename T>
void expect_numbers(std::initializer_list<std::pair<T, std::uint32_t>> pairs) {
  int line = 0;
  for (const auto& [name, number] : pairs) {
    EXPECT_EQ(static_cast<std::uint32_t>(name), number) << "line " << line;
    ++line;
  }
}

// CiA 301, table 22.
TEST(StandardNumbers, OfAbortCodes) {
  using enum AbortCode;
  expect_numbers<AbortCode>({{kNone, 0},
                             {kBusy, 1},
                             {kToggleBitNotAlternated, 0x0503'0000},
                             {kTimedOut, 0x0504'0000},
                             {kCommandSpecifierUnknown, 0x0504'0001},
                             {kInvalidBlockSize, 0x0504'0002},
                             {kInvalidSequenceNumber, 0x0504'0003},
                             {kCrcError, 0x0504'0004},
                             {kOutOfMemory, 0x0504'0005},
                             {kUnsupportedAccess, 0x0601'0000},
                             {kReadOfWriteOnly, 0x0601'0001},
                             {kWriteOfReadOnly, 0x0601'0002},
                             {kObjectDoesNotExist, 0x0602'0000},
                             {kNotMappable, 0x0604'0041},
                             {kPdoLengthExceeded, 0x0604'0042},
                             {kParameterIncompatibility, 0x0604'0043},
                             {kInternalIncompatibility, 0x0604'0047},
                             {kHardwareError, 0x0606'0000},
                             {kLengthMismatch, 0x0607'0010},
                             {kLengthTooHigh, 0x0607'0012},
                             {kLengthTooLow, 0x0607'0013},
                             {kSubindexDoesNotExist, 0x0609'0011},
                             {kInvalidValue, 0x0609'0030},
                             {kValueTooHigh, 0x0609'0031},
                             {kValueTooLow, 0x0609'0032},
                             {kMaximumBelowMinimum, 0x0609'0036},
                             {kResourceNotAvailable, 0x060A'0023},
                             {kGeneralError, 0x0800'0000},
                             {kCannotTransfer, 0x0800'0020},
                             {kLocalControl, 0x0800'0021},
                             {kDeviceState, 0x0800'0022},
                             {kNoDictionary, 0x0800'0023},
                             {kNoData, 0x0800'0024}});
}

// CiA 301, table 44; 7.2.8.2.1 and 7.3.2.2; 7.5.2.13 and 7.5.2.30.
TEST(StandardNumbers, OfTypesAndStates) {
  expect_numbers<DataType>({{DataType::kBoolean, 1},
                            {DataType::kInteger8, 2},
                            {DataType::kInteger16, 3},
                            {DataType::kInteger32, 4},
                            {DataType::kUnsigned8, 5},
                            {DataType::kUnsigned16, 6},
                            {DataType::kUnsigned32, 7},
                            {DataType::kVisibleString, 9},
                            {DataType::kDomain, 15}});
  expect_numbers<NmtState>({{NmtState::kInitialising, 0},
                            {NmtState::kStopped, 4},
                            {NmtState::kOperational, 5},
                            {NmtState::kPreOperational, 127}});
  expect_numbers<NmtCommand>({{NmtCommand::kStart, 1},
                              {NmtCommand::kStop, 2},
                              {NmtCommand::kEnterPreOperational, 128},
                              {NmtCommand::kResetNode, 129},
                              {NmtCommand::kResetCommunication, 130}});
  expect_numbers<ParameterGroup>({{ParameterGroup::kAll, 1},
                                  {ParameterGroup::kCommunication, 2},
                                  {ParameterGroup::kApplication, 3},
                                  {ParameterGroup::kManufacturer, 4}});
  expect_numbers<CommunicationError>({{CommunicationError::kEnterPreOperational, 0},
                                      {CommunicationError::kNoChange, 1},
                                      {CommunicationError::kStop, 2}});
  EXPECT_EQ(kAllGroups, 0b1111);
}

// CiA 301, tables 38 and 39.
TEST(StandardNumbers, OfIdentifiers) {
  expect_numbers<std::uint32_t>({{kNmtCobId, 0x000},
                                 {kSyncCobId, 0x080},
                                 {kEmergencyBase, 0x080},
                                 {kTpdo1Base, 0x180},
                                 {kRpdo1Base, 0x200},
                                 {kPdoStep, 0x100},
                                 {kSdoResponseBase, 0x580},
                                 {kSdoRequestBase, 0x600},
                                 {kHeartbeatBase, 0x700},
                                 {kFunctionCodeMask, 0x780},
                                 {kCobIdMask, 0x7FF},
                                 {kCobIdInvalid, 0x8000'0000},
                                 {kCobIdNoRemote, 0x4000'0000},
                                 {kSyncProducer, 0x4000'0000},
                                 {kCobIdExtended, 0x2000'0000},
                                 {kMaxNodeId, 127},
                                 {kUnconfiguredNodeId, 255}});
}

// CiA 301, table 40: the ends of each range.
TEST(StandardNumbers, OfRestrictedIdentifiers) {
  for (const int restricted : {0x000, 0x001, 0x07F, 0x101, 0x180, 0x581, 0x5FF, 0x601, 0x67F, 0x6E0, 0x6FF,
                               0x701, 0x77F, 0x780, 0x7FF})
    EXPECT_TRUE(is_restricted(static_cast<std::uint16_t>(restricted))) << std::hex << restricted;
  for (const int free : {0x080, 0x100, 0x181, 0x580, 0x600, 0x680, 0x6DF})
    EXPECT_FALSE(is_restricted(static_cast<std::uint16_t>(free))) << std::hex << free;
}

// CiA 301, 7.2.4.3.
TEST(StandardNumbers, OfSdoCommands) {
  using namespace sdo;
  expect_numbers<std::uint32_t>({{kDownloadSegmentRequest, 0x00},
                                 {kInitiateDownloadRequest, 0x20},
                                 {kInitiateUploadRequest, 0x40},
                                 {kUploadSegmentRequest, 0x60},
                                 {kUploadSegmentResponse, 0x00},
                                 {kDownloadSegmentResponse, 0x20},
                                 {kInitiateUploadResponse, 0x40},
                                 {kInitiateDownloadResponse, 0x60},
                                 {kAbort, 0x80},
                                 {kBlockDownloadRequest, 0xC0},
                                 {kBlockDownloadResponse, 0xA0},
                                 {kBlockUploadRequest, 0xA0},
                                 {kBlockUploadResponse, 0xC0},
                                 {kSpecifierMask, 0xE0},
                                 {kExpedited, 2},
                                 {kSizeIndicated, 1},
                                 {kToggle, 16},
                                 {kLastSegment, 1},
                                 {kSegmentBytes, 7},
                                 {kBlockSubcommandMask, 3},
                                 {kBlockInitiate, 0},
                                 {kBlockEnd, 1},
                                 {kBlockConfirm, 2},
                                 {kBlockStartUpload, 3},
                                 {kBlockSizeIndicated, 2},
                                 {kBlockCrc, 4},
                                 {kBlockLastSegment, 0x80},
                                 {kMaxBlockSize, 127}});
  for (int segments = 0; segments <= 255; ++segments)
    EXPECT_EQ(is_block_size(static_cast<std::uint8_t>(segments)), segments >= 1 && segments <= 127);
  for (unsigned unused = 0; unused < 7; ++unused) {
    EXPECT_EQ(segment_size(static_cast<std::uint8_t>(unused << 1 | 0x11)), 7 - unused);
    EXPECT_EQ(block_end_size(static_cast<std::uint8_t>(0xC1 | unused << 2)), 7 - unused);
  }
  EXPECT_EQ(expedited_size(0x42), 4u);  // the size is not indicated
  EXPECT_EQ(crc16(0, std::to_array<std::uint8_t>({'1', '2', '3', '4', '5', '6', '7', '8', '9'})), 0x31C3);
}

// CiA 305, chapter 7.
TEST(StandardNumbers, OfLssCommands) {
  using enum LssCommand;
  expect_numbers<LssCommand>({{kSwitchGlobal, 0x04},
                              {kConfigureNodeId, 0x11},
                              {kConfigureBitTiming, 0x13},
                              {kActivateBitTiming, 0x15},
                              {kStore, 0x17},
                              {kSwitchVendor, 0x40},
                              {kSwitchSerial, 0x43},
                              {kSwitched, 0x44},
                              {kIdentifyVendor, 0x46},
                              {kIdentifySerialHigh, 0x4B},
                              {kIdentifyUnconfigured, 0x4C},
                              {kIdentified, 0x4F},
                              {kIdentifiedUnconfigured, 0x50},
                              {kFastscan, 0x51},
                              {kInquireVendor, 0x5A},
                              {kInquireNodeId, 0x5E}});
}

// CiA 301, tables 26 and 48; CiA 402-2.
TEST(StandardNumbers, OfErrors) {
  expect_numbers<std::uint32_t>(
      {{error_register::kGeneric, 1},         {error_register::kCurrent, 2},
       {error_register::kVoltage, 4},         {error_register::kTemperature, 8},
       {error_register::kCommunication, 16},  {error_register::kProfile, 32},
       {error_register::kManufacturer, 128},  {error_code::kNoError, 0},
       {error_code::kDataSet, 0x6300},        {error_code::kParameter, 0x6320},
       {error_code::kCanOverrun, 0x8110},     {error_code::kCanErrorPassive, 0x8120},
       {error_code::kHeartbeat, 0x8130},      {error_code::kBusOffRecovered, 0x8140},
       {error_code::kPdoTooShort, 0x8210},    {error_code::kPdoTooLong, 0x8220},
       {error_code::kSyncLength, 0x8240},     {error_code::kRpdoTimeout, 0x8250},
       {cia402::kErrorOverCurrent, 0x2310},   {cia402::kErrorUnderVoltage, 0x3220},
       {cia402::kErrorTemperature, 0x4310},   {cia402::kErrorParameter, 0x6320},
       {cia402::kErrorEncoder, 0x7305},       {cia402::kErrorFollowing, 0x8611},
       {cia402::kErrorHeartbeatLost, 0x8130}, {cia402::kErrorSyncLost, 0x8700}});
}

// CiA 402-2.
TEST(StandardNumbers, OfDriveObjects) {
  using namespace cia402;
  expect_numbers<std::uint32_t>({{kAbortConnectionOption, 0x6007},
                                 {kErrorCode, 0x603F},
                                 {kControlword, 0x6040},
                                 {kStatusword, 0x6041},
                                 {kQuickStopOption, 0x605A},
                                 {kShutdownOption, 0x605B},
                                 {kDisableOperationOption, 0x605C},
                                 {kHaltOption, 0x605D},
                                 {kFaultReactionOption, 0x605E},
                                 {kModeOfOperation, 0x6060},
                                 {kModeOfOperationDisplay, 0x6061},
                                 {kPositionDemand, 0x6062},
                                 {kPositionActual, 0x6064},
                                 {kFollowingErrorWindow, 0x6065},
                                 {kFollowingErrorTimeOut, 0x6066},
                                 {kPositionWindow, 0x6067},
                                 {kPositionWindowTime, 0x6068},
                                 {kVelocityActual, 0x606C},
                                 {kMaxTorque, 0x6072},
                                 {kRatedCurrent, 0x6075},
                                 {kRatedTorque, 0x6076},
                                 {kTorqueActual, 0x6077},
                                 {kCurrentActual, 0x6078},
                                 {kSupplyVoltage, 0x6079},
                                 {kTargetPosition, 0x607A},
                                 {kHomeOffset, 0x607C},
                                 {kSoftwarePositionLimit, 0x607D},
                                 {kMaxMotorSpeed, 0x6080},
                                 {kProfileVelocity, 0x6081},
                                 {kProfileAcceleration, 0x6083},
                                 {kProfileDeceleration, 0x6084},
                                 {kQuickStopDeceleration, 0x6085},
                                 {kMotionProfileType, 0x6086},
                                 {kHomingMethod, 0x6098},
                                 {kHomingSpeeds, 0x6099},
                                 {kInterpolationTimePeriod, 0x60C2},
                                 {kMaxAcceleration, 0x60C5},
                                 {kSupportedHomingMethods, 0x60E3},
                                 {kFollowingErrorActual, 0x60F4},
                                 {kPositionDemandInternal, 0x60FC},
                                 {kSupportedDriveModes, 0x6502},
                                 {kDeviceType, 0x0002'0192}});
}

TEST(StandardNumbers, OfDriveModesAndOptions) {
  using namespace cia402;
  expect_numbers<std::int32_t>({{kNoMode, 0},
                                {kProfilePosition, 1},
                                {kHoming, 6},
                                {kCyclicSynchronousPosition, 8},
                                {kDisableDrive, 0},
                                {kStopOnSlowDownRamp, 1},
                                {kStopOnQuickStopRamp, 2},
                                {kStopAtCurrentLimit, 3},
                                {kStopAtVoltageLimit, 4},
                                {kHomeOnPositionOld, 35},
                                {kHomeOnPosition, 37}});
  for (std::int16_t option = 0; option <= 8; ++option) EXPECT_EQ(stays_in_quick_stop(option), option >= 5);
}

TEST(StandardNumbers, OfStatuswordAndControlword) {
  using namespace cia402;
  expect_numbers<std::uint32_t>({{kVoltageEnabled, 0x0010},
                                 {kRemote, 0x0200},
                                 {kTargetReached, 0x0400},
                                 {kInternalLimit, 0x0800},
                                 {kFollowsCommand, 0x1000},
                                 {kSetPointAcknowledge, 0x1000},
                                 {kHomingAttained, 0x1000},
                                 {kHomingError, 0x2000},
                                 {kFollowingError, 0x2000},
                                 {kTorqueOff, 0x4000},
                                 {kFaultReset, 0x80},
                                 {kControlDisableVoltage, 0x00},
                                 {kControlQuickStop, 0x02},
                                 {kControlShutdown, 0x06},
                                 {kControlSwitchOn, 0x07},
                                 {kControlEnableOperation, 0x0F},
                                 {kNewSetPoint, 0x10},
                                 {kStartHoming, 0x10},
                                 {kChangeImmediately, 0x20},
                                 {kRelative, 0x40},
                                 {kHalt, 0x100}});
}

// CiA 402-2, table 28, with each value of the bits that do not belong to the state.
TEST(StandardNumbers, OfDriveStates) {
  using namespace cia402;
  struct Row {
    State state;
    std::uint16_t mask;
    std::uint16_t bits;
  };
  for (const Row& row :
       {Row{State::kNotReadyToSwitchOn, 0x4F, 0x00}, Row{State::kSwitchOnDisabled, 0x4F, 0x40},
        Row{State::kReadyToSwitchOn, 0x6F, 0x21}, Row{State::kSwitchedOn, 0x6F, 0x23},
        Row{State::kOperationEnabled, 0x6F, 0x27}, Row{State::kQuickStopActive, 0x6F, 0x07},
        Row{State::kFaultReactionActive, 0x4F, 0x0F}, Row{State::kFault, 0x4F, 0x08}}) {
    EXPECT_EQ(statusword_of(row.state), row.bits);
    for (unsigned other = 0; other <= 0xFFFF; ++other) {
      const auto word = static_cast<std::uint16_t>((other & ~unsigned{row.mask}) | row.bits);
      ASSERT_EQ(state_of(word), row.state) << std::hex << word;
      ASSERT_EQ(is_operation_enabled(word), row.state == State::kOperationEnabled) << std::hex << word;
      ASSERT_EQ(follows_command(word), row.state == State::kOperationEnabled && (word & 0x1000) != 0);
    }
  }
}

// CiA 402-2, table 27; bit 7 and those above do not matter.
TEST(StandardNumbers, OfDriveCommands) {
  using namespace cia402;
  for (unsigned word = 0; word <= 0xFF; ++word) {
    const Command expected = (word & 0x2) == 0   ? Command::kDisableVoltage
                             : (word & 0x6) == 2 ? Command::kQuickStop
                             : (word & 0x7) == 6 ? Command::kShutdown
                             : (word & 0xF) == 7 ? Command::kSwitchOn
                                                 : Command::kEnableOperation;
    EXPECT_EQ(command_of(static_cast<std::uint16_t>(word)), expected) << std::hex << word;
  }
}

}  // namespace
}  // namespace koboshi::canopen
