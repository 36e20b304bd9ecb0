#pragma once

#include <span>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/described_object.h"
#include "firmware/canopen/dictionary.h"
#include "sim_board/drive/drive_dictionary.h"

// A drive's objects, CiA 402: from this table come the drive's rows, drive.eds, its part of koboshi.dbc and
// of the page docs/reference/object-dictionary.md (`koboshi dictionary write`).
namespace koboshi::sim_board {

namespace cia402 = canopen::cia402;
using canopen::named_only;
using enum canopen::Access;
using enum canopen::Mappable;

inline constexpr canopen::ValueName kAbortConnectionNames[] = {
    {0, "no action"}, {1, "fault"}, {2, "disable voltage"}, {3, "quick stop"}};
inline constexpr canopen::ValueName kStopNames[] = {{0, "disable the drive at once"},
                                                    {1, "slow down on the profile's ramp"},
                                                    {2, "slow down on the quick stop ramp"}};
inline constexpr canopen::ValueName kQuickStopNames[] = {kStopNames[0],
                                                         kStopNames[1],
                                                         kStopNames[2],
                                                         {3, "stop at the current limit"},
                                                         {4, "stop at the voltage limit"},
                                                         {5, "slow down on the profile's ramp and stay"},
                                                         {6, "slow down on the quick stop ramp and stay"},
                                                         {7, "stop at the current limit and stay"},
                                                         {8, "stop at the voltage limit and stay"}};
inline constexpr canopen::ValueName kMotionProfileNames[] = {{0, "linear ramps"}};
inline constexpr canopen::ValueName kHomingMethodNames[] = {
    {cia402::kHomeOnPositionOld, "present position (older number)"},
    {cia402::kHomeOnPosition, "present position"}};
inline constexpr auto kDisableNames = std::span(kStopNames).first<2>();
inline constexpr auto kHaltNames = std::span(kStopNames).last<2>();

inline constexpr canopen::Unit kShaftUnit{"deg", 360, 1 << cia402::kPositionUnitBits};
inline constexpr canopen::Unit kShaftSpeedUnit{"deg/s", 360, 1 << cia402::kPositionUnitBits};
inline constexpr canopen::Unit kShaftAccelerationUnit{"deg/s^2", 360, 1 << cia402::kPositionUnitBits};
inline constexpr canopen::Unit kShareUnit{"%", 1, 10};

inline constexpr std::string_view kLimitEnds[] = {"minimum", "maximum"};
inline constexpr std::string_view kHomingSpeedNames[] = {"to the switch", "to the index"};

#define OBJECT(index, subindex, member, ...) \
  canopen::object(cia402::index, subindex, KOBOSHI_FIELD(DriveValues, member), __VA_ARGS__)

inline constexpr canopen::DescribedObject kDriveObjects[] = {
    {canopen::object(kWindingTemperature, 0, KOBOSHI_FIELD(DriveValues, winding_dC), kReadOnly, kTpdo),
     {.name = "Winding temperature", .unit = {"C", 1, 10}, .comment = "As measured by the drive."}},
    {canopen::object(kMaxCyclicStep, 0, KOBOSHI_FIELD(DriveValues, largest_cyclic_step), kReadWrite),
     {.name = "Largest cyclic step",
      .unit = kShaftUnit,
      .comment = "From one target of the cyclic mode to the next; a longer one is approached by 6081, 6083 "
                 "and 6084."}},
    {canopen::object(kLimitedTime, 0, KOBOSHI_FIELD(DriveValues, limited_ms), kReadOnly, kTpdo),
     {.name = "Time at internal limit",
      .unit = {"ms"},
      .comment = "With bit 11 of the statusword set, since the reset; saturates."}},
    canopen::heading(kTimeOfDay, "Time of day", "By the last TIME message (1012); 0 before the first."),
    {canopen::object(kTimeOfDay, 1, KOBOSHI_FIELD(DriveValues, time_ms), kReadOnly),
     {.name = "Time after midnight", .unit = {"ms"}}},
    {canopen::object(kTimeOfDay, 2, KOBOSHI_FIELD(DriveValues, time_days), kReadOnly),
     {.name = "Days since 1984-01-01", .unit = {"d"}}},
    {OBJECT(kAbortConnectionOption, 0, abort_connection_option, kReadWrite).within<std::int16_t>(0, 3),
     {.name = "Abort connection option code",
      .values = kAbortConnectionNames,
      .comment = "What the drive does when the controller is lost."}},
    {OBJECT(kErrorCode, 0, error_code, kReadOnly, kTpdo),
     {.name = "Error code", .values = canopen::kErrorCodeNames, .comment = "Of the last fault."}},
    {OBJECT(kControlword, 0, controlword, kReadWrite, kRpdo),
     {.name = "Controlword", .values = cia402::kControlwordNames}},
    {OBJECT(kStatusword, 0, statusword, kReadOnly, kTpdo),
     {.name = "Statusword",
      .values = cia402::kStatuswordNames,
      .comment = "Bit 11: a limit holds the drive back (607D, 6080, 60C5, 2001), or a stop is steeper than "
                 "its ramp. "
                 "Bit 14: the drive-enable line is low, there is no torque."}},
    {named_only(OBJECT(kQuickStopOption, 0, quick_stop_option, kReadWrite), kQuickStopNames),
     {.name = "Quick stop option code",
      .values = kQuickStopNames,
      .comment = "Switch on disabled follows, or quick stop active stays."}},
    {named_only(OBJECT(kShutdownOption, 0, shutdown_option, kReadWrite), kDisableNames),
     {.name = "Shutdown option code", .values = kDisableNames, .comment = "From operation enabled."}},
    {named_only(OBJECT(kDisableOperationOption, 0, disable_operation_option, kReadWrite), kDisableNames),
     {.name = "Disable operation option code", .values = kDisableNames}},
    {named_only(OBJECT(kHaltOption, 0, halt_option, kReadWrite), kHaltNames),
     {.name = "Halt option code",
      .values = kHaltNames,
      .comment = "Profile position mode; operation stays enabled."}},
    {named_only(OBJECT(kFaultReactionOption, 0, fault_reaction_option, kReadWrite), kStopNames),
     {.name = "Fault reaction option code",
      .values = kStopNames,
      .comment = "Without a position the drive is disabled at once."}},
    {named_only(OBJECT(kModeOfOperation, 0, mode, kReadWrite, kRpdo).parameter(), cia402::kModeNames),
     {.name = "Modes of operation",
      .values = cia402::kModeNames,
      .comment = "Takes effect when no motion is under way, see the display."}},
    {OBJECT(kModeOfOperationDisplay, 0, mode_display, kReadOnly, kTpdo),
     {.name = "Modes of operation display", .values = cia402::kModeNames}},
    {OBJECT(kPositionDemand, 0, position_demand, kReadOnly, kTpdo),
     {.name = "Position demand value",
      .unit = kShaftUnit,
      .comment = "Of the profile or the interpolation."}},
    {OBJECT(kPositionActual, 0, position_actual, kReadOnly, kTpdo),
     {.name = "Position actual value", .unit = kShaftUnit}},
    {OBJECT(kFollowingErrorWindow, 0, following_window, kReadWrite),
     {.name = "Following error window",
      .unit = kShaftUnit,
      .comment = "Allowed deviation from the demand; FFFFFFFFh: not monitored."}},
    {OBJECT(kFollowingErrorTimeOut, 0, following_timeout_ms, kReadWrite),
     {.name = "Following error time out",
      .unit = {"ms"},
      .comment = "Out of the window for longer: a fault."}},
    {OBJECT(kPositionWindow, 0, position_window, kReadWrite),
     {.name = "Position window",
      .unit = kShaftUnit,
      .comment = "Of target reached, to either side; FFFFFFFFh: the demand counts, not the shaft."}},
    {OBJECT(kPositionWindowTime, 0, position_window_ms, kReadWrite),
     {.name = "Position window time", .unit = {"ms"}}},
    {OBJECT(kVelocityActual, 0, velocity_actual, kReadOnly, kTpdo),
     {.name = "Velocity actual value", .unit = kShaftSpeedUnit, .comment = "Over the last 8 ms."}},
    {OBJECT(kMaxTorque, 0, max_torque_permille, kReadWrite).within<std::uint16_t>(0, kFullTorque_permille),
     {.name = "Max torque",
      .unit = kShareUnit,
      .comment = "Of the rated torque. 0: the shaft turns freely, although operation is enabled; 100 %: as "
                 "much as the supply gives."}},
    {OBJECT(kRatedCurrent, 0, rated_current_mA, kReadOnly),
     {.name = "Motor rated current", .unit = {"mA"}, .comment = "The stall current at nominal supply."}},
    {OBJECT(kRatedTorque, 0, rated_torque_mNm, kReadOnly),
     {.name = "Motor rated torque", .unit = {"mN m"}, .comment = "The stall torque at nominal supply."}},
    {OBJECT(kTorqueActual, 0, torque_actual_permille, kReadOnly, kTpdo),
     {.name = "Torque actual value", .unit = kShareUnit, .comment = "Of the rated torque."}},
    {OBJECT(kCurrentActual, 0, current_actual_permille, kReadOnly, kTpdo),
     {.name = "Current actual value", .unit = kShareUnit, .comment = "Of the rated current."}},
    {OBJECT(kSupplyVoltage, 0, supply_mV, kReadOnly, kTpdo),
     {.name = "DC link circuit voltage", .unit = {"mV"}, .comment = "As measured by the drive."}},
    {OBJECT(kTargetPosition, 0, target_position, kReadWrite, kRpdo),
     {.name = "Target position",
      .unit = kShaftUnit,
      .comment = "Reached by interpolation over a cycle, or by a profile. Enabling, homing, a change of the "
                 "mode and a reset set it to the present position."}},
    {OBJECT(kHomeOffset, 0, home_offset, kReadWrite).within<std::int32_t>(-(1 << 30), 1 << 30),
     {.name = "Home offset",
      .unit = kShaftUnit,
      .comment = "The position actual value at home; positions count from there until a reset."}},
    canopen::heading(
        cia402::kSoftwarePositionLimit, "Software position limit",
        "No target lies beyond. Operation is not enabled while the minimum is above the maximum: "
        "error 6320."),
    {OBJECT(kSoftwarePositionLimit, 1, position_limit[0], kReadWrite).repeated(2, 4),
     {.name = "Position limit", .unit = kShaftUnit, .elements = kLimitEnds}},
    {OBJECT(kMaxMotorSpeed, 0, max_motor_speed_rpm, kReadWrite).within<std::uint32_t>(1, 100'000),
     {.name = "Max motor speed", .unit = {"r/min"}, .comment = "Of the shaft, in every mode."}},
    {OBJECT(kProfileVelocity, 0, profile_velocity, kReadWrite, kRpdo)
         .within<std::uint32_t>(1, 0x7FFF'FFFF)
         .parameter(),
     {.name = "Profile velocity", .unit = kShaftSpeedUnit}},
    {OBJECT(kProfileAcceleration, 0, profile_acceleration, kReadWrite, kRpdo)
         .within<std::uint32_t>(1'000, 0x7FFF'FFFF)
         .parameter(),
     {.name = "Profile acceleration", .unit = kShaftAccelerationUnit}},
    {OBJECT(kProfileDeceleration, 0, profile_deceleration, kReadWrite, kRpdo)
         .within<std::uint32_t>(1'000, 0x7FFF'FFFF)
         .parameter(),
     {.name = "Profile deceleration",
      .unit = kShaftAccelerationUnit,
      .comment = "Also applies to slow-down ramps; a stop takes 1 s at most."}},
    {OBJECT(kQuickStopDeceleration, 0, quick_stop_deceleration, kReadWrite)
         .within<std::uint32_t>(1'000, 0x7FFF'FFFF),
     {.name = "Quick stop deceleration",
      .unit = kShaftAccelerationUnit,
      .comment = "After a reset from the joint's highest speed, see the robot's file. A stop takes 1 s at "
                 "most."}},
    {OBJECT(kMotionProfileType, 0, motion_profile_type, kReadWrite).within<std::int16_t>(0, 0),
     {.name = "Motion profile type", .values = kMotionProfileNames}},
    {named_only(OBJECT(kHomingMethod, 0, homing_method, kReadWrite), kHomingMethodNames),
     {.name = "Homing method",
      .values = kHomingMethodNames,
      .comment = "35 or 37: the present position is home; nothing moves."}},
    canopen::heading(cia402::kHomingSpeeds, "Homing speeds", "Not used: no homing method moves."),
    {OBJECT(kHomingSpeeds, 1, homing_speed[0], kReadWrite).repeated(2, 4),
     {.name = "Homing speed", .unit = kShaftSpeedUnit, .elements = kHomingSpeedNames}},
    canopen::heading(cia402::kInterpolationTimePeriod, "Interpolation time period",
                     "The cycle: value * 10^index seconds."),
    {OBJECT(kInterpolationTimePeriod, 1, interpolation_period, kReadWrite).within<std::uint8_t>(1, 250),
     {.name = "Interpolation time period value"}},
    {OBJECT(kInterpolationTimePeriod, 2, interpolation_exponent, kReadWrite).within<std::int8_t>(-3, -3),
     {.name = "Interpolation time index"}},
    {OBJECT(kMaxAcceleration, 0, max_acceleration, kReadWrite).within<std::uint32_t>(1'000, 0x7FFF'FFFF),
     {.name = "Max acceleration",
      .unit = kShaftAccelerationUnit,
      .comment = "In every mode; of decelerations, those of a profile."}},
    canopen::heading(cia402::kSupportedHomingMethods, "Supported homing methods"),
    {canopen::constant<std::int8_t>(cia402::kSupportedHomingMethods, 1, cia402::kHomeOnPositionOld),
     {.name = "Supported homing method 1"}},
    {canopen::constant<std::int8_t>(cia402::kSupportedHomingMethods, 2, cia402::kHomeOnPosition),
     {.name = "Supported homing method 2"}},
    {OBJECT(kFollowingErrorActual, 0, following_error, kReadOnly, kTpdo),
     {.name = "Following error actual value", .unit = kShaftUnit, .comment = "The demand less the shaft."}},
    canopen::heading(cia402::kPositionControlParameters, "Position control parameter set"),
    {OBJECT(kPositionControlParameters, 1, position_gain_permille, kReadWrite)
         .within<std::uint16_t>(1, kMaxGain_permille),
     {.name = "Position gain",
      .unit = kShareUnit,
      .comment = "Of the position loop, as a share of the gain of the servo's data. Its damping stays."}},
    {OBJECT(kPositionDemandInternal, 0, position_demand, kReadOnly, kTpdo),
     {.name = "Position demand internal value",
      .unit = kShaftUnit,
      .comment = "As 6062: the drive's own unit is that of the bus."}},
    {canopen::constant<std::uint32_t>(cia402::kSupportedDriveModes, 0,
                                      1u << (cia402::kProfilePosition - 1) | 1u << (cia402::kHoming - 1) |
                                          1u << (cia402::kCyclicSynchronousPosition - 1)),
     {.name = "Supported drive modes",
      .comment = "Bit 0: profile position; bit 5: homing; bit 7: cyclic synchronous position."}},
};
static_assert(canopen::is_described(kDriveObjects));

#undef OBJECT

}  // namespace koboshi::sim_board
