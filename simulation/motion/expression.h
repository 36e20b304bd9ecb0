#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/motion/joints.h"
#include "simulation/motion/source.h"

namespace koboshi::simulation {

// A value that expressions can read, with its number in the image.
struct Sensor {
  enum class Index : std::uint8_t { kNone, kJoint, kInput };
  // What a mirrored robot would measure: the same, the opposite, or the value of the other side.
  enum class Mirror : std::uint8_t { kSame, kOpposite, kOtherSide };

  std::string_view name;
  std::uint8_t number;
  Index index = Index::kNone;
  Mirror mirror = Mirror::kSame;
};

inline constexpr std::size_t kInputs = 8;
inline constexpr std::array<Sensor, 20> kSensors{
    {{"roll_mdeg", 1, Sensor::Index::kNone, Sensor::Mirror::kOpposite},
     {"pitch_mdeg", 2},
     {"roll_rate_mdeg_per_s", 3, Sensor::Index::kNone, Sensor::Mirror::kOpposite},
     {"pitch_rate_mdeg_per_s", 4},
     {"yaw_rate_mdeg_per_s", 5, Sensor::Index::kNone, Sensor::Mirror::kOpposite},
     {"left_contact", 6, Sensor::Index::kNone, Sensor::Mirror::kOtherSide},
     {"right_contact", 7, Sensor::Index::kNone, Sensor::Mirror::kOtherSide},
     {"left_load_mN", 8, Sensor::Index::kNone, Sensor::Mirror::kOtherSide},
     {"right_load_mN", 9, Sensor::Index::kNone, Sensor::Mirror::kOtherSide},
     {"zmp_x_um", 10},
     {"zmp_y_um", 11, Sensor::Index::kNone, Sensor::Mirror::kOpposite},
     {"zmp_valid", 12},
     {"angle_mdeg", 13, Sensor::Index::kJoint},
     {"error_mdeg", 14, Sensor::Index::kJoint},
     {"torque_permille", 15, Sensor::Index::kJoint},
     {"supply_mV", 16},
     {"input", 17, Sensor::Index::kInput},
     {"stopping", 18},
     {"walking", 19},
     {"time_ms", 20}}};

// Returns the sensor of a name or of a number in the image; nullptr if there is none.
[[nodiscard]] const Sensor* find_sensor(std::string_view name);
[[nodiscard]] const Sensor* find_sensor(std::uint8_t number);

// Whether the language has this word: a sensor, an operator or a function. No variable may have it as a name.
[[nodiscard]] bool is_reserved(std::string_view name);
// Whether the text is a letter or `_`, followed by letters, digits and `_`.
[[nodiscard]] bool is_identifier(std::string_view text);

// Parses an expression; constant parts are computed. `place` is that of the text's first letter. Reports the
// first error and returns nothing.
[[nodiscard]] std::optional<Expression> parse_expression(std::string_view text, const Place& place,
                                                         const std::vector<VariableSource>& variables,
                                                         const JointNames& joints, Diagnostics& diagnostics);

// Returns a condition as it is, and a number as its comparison with zero.
[[nodiscard]] Expression as_condition(Expression expression);

// The arithmetic of the firmware: saturates at the ends of int32; division truncates. Nothing: division by
// zero, or no arithmetic operator.
[[nodiscard]] std::optional<std::int32_t> compute(Expression::Kind kind, std::int32_t left,
                                                  std::int32_t right);

}  // namespace koboshi::simulation
