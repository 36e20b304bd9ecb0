#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/motion/instructions.h"

namespace koboshi::simulation {

// A sensor that expressions can read.
struct Sensor {
  enum class Index : std::uint8_t { kNone, kJoint, kInput };
  // Effect of mirroring on the value: none, the opposite sign, or an exchange with the other side.
  enum class Mirror : std::uint8_t { kSame, kOpposite, kOtherSide };

  std::string_view name;
  motion::Source source;
  Index index = Index::kNone;
  Mirror mirror = Mirror::kSame;
};

inline constexpr std::size_t kInputs = 8;
inline constexpr std::array<Sensor, 20> kSensors{
    {{"roll_mdeg", motion::Source::kRoll, Sensor::Index::kNone, Sensor::Mirror::kOpposite},
     {"pitch_mdeg", motion::Source::kPitch},
     {"roll_rate_mdeg_per_s", motion::Source::kRollRate, Sensor::Index::kNone, Sensor::Mirror::kOpposite},
     {"pitch_rate_mdeg_per_s", motion::Source::kPitchRate},
     {"yaw_rate_mdeg_per_s", motion::Source::kYawRate, Sensor::Index::kNone, Sensor::Mirror::kOpposite},
     {"left_contact", motion::Source::kLeftContact, Sensor::Index::kNone, Sensor::Mirror::kOtherSide},
     {"right_contact", motion::Source::kRightContact, Sensor::Index::kNone, Sensor::Mirror::kOtherSide},
     {"left_load_mN", motion::Source::kLeftLoad, Sensor::Index::kNone, Sensor::Mirror::kOtherSide},
     {"right_load_mN", motion::Source::kRightLoad, Sensor::Index::kNone, Sensor::Mirror::kOtherSide},
     {"zmp_x_um", motion::Source::kZmpX},
     {"zmp_y_um", motion::Source::kZmpY, Sensor::Index::kNone, Sensor::Mirror::kOpposite},
     {"zmp_valid", motion::Source::kZmpValid},
     {"angle_mdeg", motion::Source::kJointAngle, Sensor::Index::kJoint},
     {"error_mdeg", motion::Source::kJointError, Sensor::Index::kJoint},
     {"torque_permille", motion::Source::kJointTorque, Sensor::Index::kJoint},
     {"supply_mV", motion::Source::kSupply},
     {"input", motion::Source::kInput, Sensor::Index::kInput},
     {"stopping", motion::Source::kStopping},
     {"walking", motion::Source::kWalking},
     {"time_ms", motion::Source::kTime}}};

// Returns the sensor of a name or of a source; nullptr if there is none.
[[nodiscard]] const Sensor* find_sensor(std::string_view name);
[[nodiscard]] const Sensor* find_sensor(motion::Source source);

}  // namespace koboshi::simulation
