#pragma once

#include "firmware/canopen/described_object.h"
#include "firmware/canopen/dictionary.h"
#include "sim_board/sensor/sensor_dictionary.h"

// Objects of the two kinds of sensor nodes. Source of the nodes' object dictionaries and, by `koboshi
// dictionary write`, of inertial.eds, ankle.eds, koboshi.dbc and docs/reference/object-dictionary.md.
namespace koboshi::sim_board {

using enum canopen::Access;
using enum canopen::Mappable;

inline constexpr canopen::ValueName kSensorKindNames[] = {
    canopen::value_name(SensorKind::kInertial, "inertial unit"),
    canopen::value_name(SensorKind::kForceTorque, "force/torque sensor"),
    canopen::value_name(SensorKind::kPressureCells, "pressure cells"),
    canopen::value_name(SensorKind::kContactSwitch, "contact switch"),
};

inline constexpr canopen::Unit kGyroCount{.name = "deg/s", .resolution = canopen::Resolution::kGyro};
inline constexpr canopen::Unit kAccelerometerCount{.name = "m/s^2",
                                                   .resolution = canopen::Resolution::kAccelerometer};
inline constexpr canopen::Unit kForceCount{.name = "N", .resolution = canopen::Resolution::kForce};
inline constexpr canopen::Unit kTorqueCount{.name = "N m", .resolution = canopen::Resolution::kTorque};

#define OBJECT(index, subindex, member, ...) \
  canopen::object(index, subindex, KOBOSHI_FIELD(SensorValues, member), __VA_ARGS__)

inline constexpr canopen::DescribedObject kSensorKind{OBJECT(0x2000, 0, kind, kReadOnly),
                                                      {.name = "Sensor kind", .values = kSensorKindNames}};
inline constexpr canopen::DescribedObject kSensorSample{
    OBJECT(0x2001, 0, sample, kReadOnly, kTpdo),
    {.name = "Sample", .comment = "Number of the sample; wraps. Both PDOs of a sample carry it."}};

inline constexpr auto kSensorTime =
    canopen::heading(0x2003, "Time of day", "By the last TIME message (1012); 0 before the first.");
inline constexpr canopen::DescribedObject kSensorTimeMs{OBJECT(0x2003, 1, time_ms, kReadOnly),
                                                        {.name = "Time after midnight", .unit = {"ms"}}};
inline constexpr canopen::DescribedObject kSensorTimeDays{OBJECT(0x2003, 2, time_days, kReadOnly),
                                                          {.name = "Days since 1984-01-01", .unit = {"d"}}};

inline constexpr canopen::DescribedObject kInertialObjects[] = {
    kSensorKind,
    kSensorSample,
    kSensorTime,
    kSensorTimeMs,
    kSensorTimeDays,
    canopen::heading(0x2010, "Gyro", "In the sensor's frame."),
    {OBJECT(0x2010, 1, gyro[0], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "Gyro", .unit = kGyroCount, .elements = canopen::kAxes}},
    canopen::heading(0x2011, "Accelerometer", "Specific force: +1 g upwards at rest."),
    {OBJECT(0x2011, 1, accelerometer[0], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "Accelerometer", .unit = kAccelerometerCount, .elements = canopen::kAxes}},
};
static_assert(canopen::is_described(kInertialObjects));

inline constexpr canopen::DescribedObject kAnkleObjects[] = {
    kSensorKind,
    kSensorSample,
    kSensorTime,
    kSensorTimeMs,
    kSensorTimeDays,
    canopen::heading(0x2020, "Force", "Exerted by the ground side on the shank side."),
    {OBJECT(0x2020, 1, force[0], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "Force", .unit = kForceCount, .elements = canopen::kAxes}},
    canopen::heading(0x2021, "Torque", "About the sensor's origin."),
    {OBJECT(0x2021, 1, torque[0], kReadOnly, kTpdo).repeated(3, 2),
     {.name = "Torque", .unit = kTorqueCount, .elements = canopen::kAxes}},
};
static_assert(canopen::is_described(kAnkleObjects));

inline constexpr canopen::DescribedObject kPressureCellObjects[] = {
    kSensorKind,
    kSensorSample,
    kSensorTime,
    kSensorTimeMs,
    kSensorTimeDays,
    canopen::heading(0x7100, "AI input field value", "The force on each cell, in counts (CiA 404)."),
    {OBJECT(0x7100, 1, cells[0], kReadOnly, kTpdo).repeated(hal::kPressureCells, 2),
     {.name = "Cell", .unit = kForceCount}},
};
static_assert(canopen::is_described(kPressureCellObjects));

inline constexpr canopen::DescribedObject kContactSwitchObjects[] = {
    kSensorKind,
    kSensorSample,
    kSensorTime,
    kSensorTimeMs,
    kSensorTimeDays,
    canopen::heading(0x6000, "Read input 8-bit", "CiA 401."),
    {OBJECT(0x6000, 1, contact, kReadOnly, kTpdo),
     {.name = "Contact", .comment = "Bit 0: the switch is closed, the foot bears a load."}},
};
static_assert(canopen::is_described(kContactSwitchObjects));

#undef OBJECT

}  // namespace koboshi::sim_board
