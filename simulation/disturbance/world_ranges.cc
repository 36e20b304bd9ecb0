#include "simulation/disturbance/world_ranges.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "base/text/user_units.h"

namespace koboshi::simulation {
namespace {

// A joint that is trimmed by eye against the edge of a link of 65 mm is off by some tenths of a millimetre
// there: in every world.
constexpr Range kEncoderOffset_rad = symmetric(0.005);

// The differences between floors and between robots of one design, whose model is right. Kit servos have a
// backlash of about 0.01 rad (the models of RoboCup's Humanoid League Virtual Season).
WorldRanges mild() {
  return {.name = "mild",
          .mass_factor = around_one(0.1),
          .backlash_rad = {0.0, 0.01},
          .encoder_offset_rad = kEncoderOffset_rad,
          .supply_factor = around_one(0.1),
          .friction = {0.4, 1.0},
          .tilt_rad = {0.0, 2.0 * kRadPerDegree}};
}

// A robot whose model has errors of the size that an identification leaves.
WorldRanges rough() {
  return {.name = "rough",
          .com_m = symmetric(0.005),
          .mass_factor = around_one(0.1),
          .backlash_rad = {0.0, 0.012},
          .encoder_offset_rad = kEncoderOffset_rad,
          .servo_gain_divisor = {1.0, 1.5},
          .load_friction = {0.0, 0.11},
          .motor_constant_factor = around_one(0.05),
          .supply_factor = around_one(0.1),
          .sensor_latency_s = {0.0, 0.01},
          .drive_latency_s = {0.0, 0.005},
          .tick_jitter_s = {0.0, 0.001},
          .friction = {0.3, 1.2},
          .tilt_rad = {0.0, 2.5 * kRadPerDegree},
          .gyro_noise_density = 0.0075 * kRadPerDegree,
          .gyro_random_walk = 2e-5};
}

// A robot that was built by another's drawings, from parts of unknown quality.
WorldRanges harsh() {
  return {.name = "harsh",
          .com_m = symmetric(0.01),
          .mass_factor = around_one(0.15),
          .backlash_rad = {0.0, 0.02},
          .encoder_offset_rad = kEncoderOffset_rad,
          .servo_gain_divisor = {1.0, 2.0},
          .load_friction = {0.0, 0.22},
          .motor_constant_factor = around_one(0.1),
          .supply_factor = around_one(0.15),
          .sensor_latency_s = {0.0, 0.02},
          .drive_latency_s = {0.0, 0.01},
          .tick_jitter_s = {0.0, 0.002},
          .friction = {0.2, 1.5},
          .tilt_rad = {0.0, 5.0 * kRadPerDegree},
          .gyro_noise_density = 0.01 * kRadPerDegree,
          .gyro_random_walk = 1e-4,
          .weak_joint = true};
}

const std::array<WorldRanges, 3>& worlds() {
  static const std::array<WorldRanges, 3> kWorlds{mild(), rough(), harsh()};
  return kWorlds;
}

}  // namespace

const std::vector<std::string>& world_names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const WorldRanges& world : worlds()) names.push_back(world.name);
    return names;
  }();
  return kNames;
}

const WorldRanges& world_named(std::string_view name) {
  const auto found = std::ranges::find(worlds(), name, &WorldRanges::name);
  if (found == worlds().end()) throw std::out_of_range("no world is called " + std::string(name));
  return *found;
}

}  // namespace koboshi::simulation
