#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <string_view>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/emergency.h"
#include "firmware/canopen/frame.h"

// Names, units and comments of objects, from which EDS (CiA 306), DBC and reference page are generated; and
// the names of values that CiA 301 and CiA 402 define.
namespace koboshi::canopen {

struct ValueName {
  std::int32_t value;
  std::string_view name;
};

// The name of a value; empty if it has none.
constexpr std::string_view name_of(std::span<const ValueName> names, std::int64_t value) {
  const auto named =
      std::ranges::find_if(names, [value](const ValueName& candidate) { return candidate.value == value; });
  return named == names.end() ? std::string_view() : named->name;
}

// The sensor whose counts an object shows. Unit::name is then the unit; the scale factor is in the robot
// file.
enum class Resolution : std::uint8_t { kNone, kGyro, kAccelerometer, kForce, kTorque };

// The unit of an object: a value is raw * numerator / denominator of it, exactly.
struct Unit {
  std::string_view name = {};
  std::int32_t numerator = 1;
  std::int32_t denominator = 1;
  Resolution resolution = Resolution::kNone;
};

struct ObjectText {
  std::string_view name = {};  // of an index, or of a sub-index
  Unit unit = {};
  std::span<const ValueName> values = {};
  // The last word of the name of each sub-index of a repeated row; if empty, its number.
  std::span<const std::string_view> elements = {};
  std::string_view comment = {};  // one line
  // When a written value takes effect: "at the next walk". Empty: as the heading of its index, or at once.
  std::string_view effect = {};
};

// The row, which refuses every value that has no name, whichever service writes it. The names are in
// ascending order; the last exceeds the first by 31 at most.
constexpr Entry named_only(Entry row, std::span<const ValueName> names) {
  row.listed = true;
  row.low = static_cast<std::uint32_t>(names.front().value);
  row.high = 0;
  for (const ValueName& name : names) row.high |= 1u << (static_cast<std::uint32_t>(name.value) - row.low);
  return row;
}

struct DescribedObject {
  Entry entry;  // count 0: a heading, without a row
  ObjectText text;

  constexpr bool is_heading() const { return entry.count == 0; }
};

// The name of an index with sub-indices, above their rows in the table.
constexpr DescribedObject heading(std::uint16_t index, std::string_view name, std::string_view comment = {},
                                  std::string_view effect = {}) {
  return {.entry = {.index = index, .count = 0},
          .text = {.name = name, .comment = comment, .effect = effect}};
}

inline constexpr std::string_view kAxes[] = {"x", "y", "z"};

// The rows of a table without their texts. The table must have static storage.
template <const auto& kTable>
consteval auto rows_of() {
  constexpr auto kHasRow = [](const DescribedObject& object) { return !object.is_heading(); };
  std::array<Entry, std::count_if(std::begin(kTable), std::end(kTable), kHasRow)> rows;
  auto row = rows.begin();
  for (const DescribedObject& object : kTable) {
    if (kHasRow(object)) *row++ = object.entry;
  }
  return rows;
}

// Whether every row has a name, as many elements as sub-indices where it names any, and a heading above it if
// its index has sub-indices. Every table asserts it.
constexpr bool is_described(std::span<const DescribedObject> table) {
  std::uint16_t headed = 0;
  for (const DescribedObject& object : table) {
    if (object.text.name.empty() || object.text.unit.denominator <= 0) return false;
    if (object.is_heading()) headed = object.entry.index;
    if (object.entry.subindex != 0 && object.entry.index != headed) return false;
    if (!object.text.elements.empty() && object.text.elements.size() != object.entry.count) return false;
  }
  return true;
}

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

// Error codes of CiA 301, table 26, and CiA 402-2 that nodes of this robot report.
inline constexpr ValueName kErrorCodeNames[] = {
    value_name(error_code::kNoError, "no error"),
    value_name(cia402::kErrorOverCurrent, "over-current"),
    value_name(cia402::kErrorUnderVoltage, "under-voltage"),
    value_name(cia402::kErrorTemperature, "drive too hot"),
    value_name(error_code::kDataSet, "data set"),
    value_name(cia402::kErrorParameter, "parameter error"),
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
    {0xFF01, "no torque limit"},
    {0xFF02, "policy stopped"},
    {0xFF03, "no position gain"},
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

// Names of whole statuswords, since a name cannot mask bits: each state with the bits that accompany it, with
// the drive-enable line high and low; then a fault without supply, with both; the last is operation enabled
// with an active limit.
inline constexpr auto kStatuswordNames = [] {
  constexpr std::size_t kStates = std::size(kStateNames);
  std::array<ValueName, 2 * kStates + 3> names{};
  for (std::uint8_t number = 0; number < kStates; ++number) {
    const auto state = static_cast<State>(number);
    const bool enabled = state == State::kOperationEnabled;
    const unsigned word = statusword_of(state) | kRemote | kVoltageEnabled | (enabled ? kFollowsCommand : 0u);
    names[number] = value_name(word, kStateNames[number]);
    names[kStates + number] = value_name(word | kTorqueOff, kTorqueOffStateNames[number]);
    if (enabled) names.back() = value_name(word | kInternalLimit, "operation enabled, limit active");
  }
  constexpr unsigned kUnsupplied = statusword_of(State::kFault) | kRemote;
  names[2 * kStates] = value_name(kUnsupplied, "fault, no supply");
  names[2 * kStates + 1] = value_name(kUnsupplied | kTorqueOff, "fault, no supply, torque off");
  return names;
}();

}  // namespace cia402

}  // namespace koboshi::canopen
