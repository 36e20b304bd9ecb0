#include "simulation/motion_language/parse/parse_expect.h"

#include <array>
#include <cmath>

#include "base/text/user_units.h"

namespace koboshi::simulation {
namespace {

// For a trunk with roll r about x, then pitch p about y, the world's up vector in trunk axes is (-sin p, sin
// r cos p, cos r cos p).
motion::ExpectedAttitude attitude_of(double roll_deg, double pitch_deg, double within_deg) {
  const double roll = roll_deg * kRadPerDegree;
  const double pitch = pitch_deg * kRadPerDegree;
  const double within = within_deg * kRadPerDegree;
  const std::array<double, 3> up_B{-std::sin(pitch), std::sin(roll) * std::cos(pitch),
                                   std::cos(roll) * std::cos(pitch)};
  motion::ExpectedAttitude attitude;
  for (std::size_t i = 0; i < up_B.size(); ++i) {
    attitude.up_B[i] = static_cast<std::int8_t>(std::lround(up_B[i] * 127.0));
  }
  attitude.min_cosine = static_cast<std::int16_t>(std::lround(std::cos(within) * 32'767.0));
  return attitude;
}

// Parses an attitude in the numbers of the image, as the decompiler writes it.
bool parse_raw_expect(const YamlNode& value, Reader& reader, motion::ExpectedAttitude& attitude) {
  const std::size_t errors = reader.diagnostics().error_count();
  reader.check_keys(value, {"up", "min_cosine"});
  const YamlNode& up = *value.find("up");
  if (up.kind != YamlNode::Kind::kList || up.items.size() != 3) {
    reader.bad_value(up, "a list of 3 integers");
  } else {
    for (std::size_t i = 0; i < 3; ++i) {
      attitude.up_B[i] =
          static_cast<std::int8_t>(reader.integer(up.items[i], {.min = -128, .max = 127}).value_or(0));
    }
  }
  if (const YamlNode* cosine = reader.require(value, "min_cosine", "an integer from -32768 to 32767")) {
    attitude.min_cosine =
        static_cast<std::int16_t>(reader.integer(*cosine, {.min = -32'768, .max = 32'767}).value_or(0));
  }
  return reader.diagnostics().error_count() == errors;
}

}  // namespace

bool parse_expect(const YamlNode& value, int version, Reader& reader, motion::ExpectedAttitude& attitude) {
  if (!reader.is_map(value)) return false;
  if (version >= 2 && value.find("up") != nullptr) return parse_raw_expect(value, reader, attitude);
  const std::size_t errors = reader.diagnostics().error_count();
  reader.check_keys(value, {"roll_deg", "pitch_deg", "within_deg"});
  const YamlNode* roll = value.find("roll_deg");
  const YamlNode* pitch = value.find("pitch_deg");
  const YamlNode* within = reader.require(value, "within_deg", "a number from 1 to 179");
  const double roll_deg = roll ? reader.number(*roll, {.min = -180.0, .max = 180.0}).value_or(0.0) : 0.0;
  const double pitch_deg = pitch ? reader.number(*pitch, {.min = -90.0, .max = 90.0}).value_or(0.0) : 0.0;
  const double within_deg = within ? reader.number(*within, {.min = 1.0, .max = 179.0}).value_or(1.0) : 1.0;
  attitude = attitude_of(roll_deg, pitch_deg, within_deg);
  return reader.diagnostics().error_count() == errors;
}

}  // namespace koboshi::simulation
