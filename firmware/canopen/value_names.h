#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/described_object.h"
#include "firmware/canopen/emergency.h"
#include "firmware/canopen/nmt.h"

// What the values of CiA 301 and CiA 402 are called, for tables of described objects.
namespace koboshi::canopen {

template <typename T>
constexpr ValueName value_name(T value, std::string_view name) {
  return {static_cast<std::int32_t>(value), name};
}

inline constexpr ValueName kNmtStateNames[] = {
    value_name(NmtState::kInitialising, "boot-up"),
    value_name(NmtState::kStopped, "stopped"),
    value_name(NmtState::kOperational, "operational"),
    value_name(NmtState::kPreOperational, "pre-operational"),
};

inline constexpr ValueName kNmtCommandNames[] = {
    value_name(NmtCommand::kStart, "start"),
    value_name(NmtCommand::kStop, "stop"),
    value_name(NmtCommand::kEnterPreOperational, "enter pre-operational"),
    value_name(NmtCommand::kResetNode, "reset node"),
    value_name(NmtCommand::kResetCommunication, "reset communication"),
};

// CiA 301, table 26, and CiA 402-2: those that nodes of this robot can tell.
inline constexpr ValueName kErrorCodeNames[] = {
    value_name(error_code::kNoError, "no error"),
    value_name(cia402::kErrorOverCurrent, "over-current"),
    value_name(cia402::kErrorUnderVoltage, "under-voltage"),
    value_name(cia402::kErrorTemperature, "drive too hot"),
    value_name(error_code::kDataSet, "data set"),
    value_name(cia402::kErrorParameter, "contradictory parameters"),
    value_name(cia402::kErrorEncoder, "encoder"),
    value_name(error_code::kCanOverrun, "CAN overrun"),
    value_name(error_code::kCanErrorPassive, "CAN error passive"),
    value_name(error_code::kHeartbeat, "heartbeat lost"),
    value_name(error_code::kBusOffRecovered, "recovered from bus-off"),
    value_name(error_code::kPdoTooShort, "PDO too short"),
    value_name(error_code::kPdoTooLong, "PDO too long"),
    value_name(error_code::kSyncLength, "SYNC length"),
    value_name(error_code::kRpdoTimeout, "RPDO timeout"),
    value_name(cia402::kErrorSyncLost, "SYNC lost"),
    value_name(cia402::kErrorFollowing, "following error"),
    {0xFF00, "behaviour fault"},
};

namespace cia402 {

inline constexpr ValueName kControlwordNames[] = {
    value_name(kControlDisableVoltage, "disable voltage"),
    value_name(kControlQuickStop, "quick stop"),
    value_name(kControlShutdown, "shutdown"),
    value_name(kControlSwitchOn, "switch on"),
    value_name(kControlEnableOperation, "enable operation"),
    value_name(kFaultReset, "fault reset"),
};

inline constexpr ValueName kModeNames[] = {{kNoMode, "none"},
                                           {kProfilePosition, "profile position"},
                                           {kHoming, "homing"},
                                           {kCyclicSynchronousPosition, "cyclic synchronous position"}};

inline constexpr std::string_view kStateNames[] = {
    "not ready to switch on", "switch on disabled", "ready to switch on",    "switched on",
    "operation enabled",      "quick stop active",  "fault reaction active", "fault",
};
inline constexpr std::string_view kTorqueOffStateNames[] = {
    "not ready to switch on, torque off", "switch on disabled, torque off",
    "ready to switch on, torque off",     "switched on, torque off",
    "operation enabled, torque off",      "quick stop active, torque off",
    "fault reaction active, torque off",  "fault, torque off",
};

// Whole statuswords, since a value's name cannot leave bits out: the states with the bits that go with them,
// and with the drive-enable line high or low; the last is operation enabled with a limit that is active.
inline constexpr auto kStatuswordNames = [] {
  constexpr std::size_t kStates = std::size(kStateNames);
  std::array<ValueName, 2 * kStates + 1> names{};
  for (std::uint8_t number = 0; number < kStates; ++number) {
    const auto state = static_cast<State>(number);
    const bool enabled = state == State::kOperationEnabled;
    const bool makes_torque =
        enabled || state == State::kQuickStopActive || state == State::kFaultReactionActive;
    const unsigned word = statusword_of(state) | kRemote | (makes_torque ? kVoltageEnabled : 0u) |
                          (enabled ? kFollowsCommand : 0u);
    names[number] = value_name(word, kStateNames[number]);
    names[kStates + number] = value_name(word | kTorqueOff, kTorqueOffStateNames[number]);
    if (enabled) names.back() = value_name(word | kInternalLimit, "operation enabled, limit active");
  }
  return names;
}();

}  // namespace cia402
}  // namespace koboshi::canopen
