#include "simulation/disturbance/world_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/text/user_units.h"

namespace koboshi::simulation {
namespace {

constexpr double kMilli = 1e3;
constexpr double kPercent = 100.0;

// Six significant digits, which hide the rounding of a unit's conversion.
std::string short_number(double value) { return fmt::format("{:.6g}", value); }

std::string range_text(const Range& range, double factor = 1.0, const std::string& unit = "") {
  const double low = factor * range.low;
  const double high = factor * range.high;
  if (low == 0.0 && high == 0.0) return "0";
  if (std::abs(low + high) < 1e-9 * high) return "+-" + short_number(high) + unit;
  if (low == high) return short_number(high) + unit;
  return short_number(low) + " to " + short_number(high) + unit;
}

// Returns a factor around one as its deviation.
std::string share_text(const Range& factor) {
  return range_text({factor.low - 1.0, factor.high - 1.0}, kPercent, " %");
}

std::string up_to(double high, double factor = 1.0) {
  return high == 0.0 ? "as in the file" : "to " + short_number(factor * high);
}

std::string or_file(const Range& range, double factor = 1.0) {
  return range == Range{} ? "as in the file" : range_text(range, factor);
}

// Lists the values of all parts in the robot's order.
template <typename Values, typename Number>
std::string list_text(const Values& values, const Number& number) {
  std::string text;
  for (const auto& value : values) text += (text.empty() ? "" : " ") + number(value);
  return text;
}

class Texts {
 public:
  void add(const std::string& factor, const std::string& text) { texts_.push_back({factor, text}); }
  void add_unless(bool as_in_file, const std::string& factor, const std::string& text) {
    if (!as_in_file) add(factor, text);
  }
  std::vector<FactorText> take() { return std::move(texts_); }

 private:
  std::vector<FactorText> texts_;
};

void add_parts(const DisturbedWorld& world, Texts& texts) {
  const auto signed_percent = [](double factor) { return fmt::format("{:+.1f}", kPercent * (factor - 1.0)); };
  const auto signed_mrad = [](double angle_rad) { return fmt::format("{:+.1f}", kMilli * angle_rad); };
  const auto mrad = [](const std::optional<double>& gap_rad) {
    return gap_rad ? fmt::format("{:.1f}", kMilli * *gap_rad) : std::string("-");
  };
  const auto one = [](double factor) { return factor == 1.0; };
  const auto zero = [](double value) { return value == 0.0; };
  const auto none = [](const std::optional<double>& value) { return !value; };
  texts.add_unless(world.com_m.isZero(0.0), "CoM of the trunk, mm",
                   fmt::format("{:+.2f} {:+.2f} {:+.2f}", kMilli * world.com_m.x(), kMilli * world.com_m.y(),
                               kMilli * world.com_m.z()));
  texts.add_unless(std::ranges::all_of(world.mass_factors, one), "link masses, %",
                   list_text(world.mass_factors, signed_percent));
  texts.add_unless(std::ranges::all_of(world.backlash_rad, none), "backlash, mrad",
                   list_text(world.backlash_rad, mrad));
  texts.add_unless(std::ranges::all_of(world.encoder_offset_rad, zero), "encoder offset, mrad",
                   list_text(world.encoder_offset_rad, signed_mrad));
}

}  // namespace

std::vector<FactorText> range_texts(const WorldRanges& ranges) {
  Texts texts;
  texts.add("CoM of the trunk, each axis, mm", range_text(ranges.com_m, kMilli));
  texts.add("link masses", share_text(ranges.mass_factor));
  texts.add("servo gain divided by", range_text(ranges.servo_gain_divisor));
  texts.add("load-dependent friction, beyond the nominal", range_text(ranges.load_friction));
  texts.add("motor constant", share_text(ranges.motor_constant_factor));
  texts.add("backlash, mrad", or_file(ranges.backlash_rad, kMilli));
  texts.add("encoder offset, mrad", range_text(ranges.encoder_offset_rad, kMilli));
  texts.add("extra latency, sensors / drives, ms",
            range_text(ranges.sensor_latency_s, kMilli) + " / " + range_text(ranges.drive_latency_s, kMilli));
  texts.add("tick jitter, ms", range_text(ranges.tick_jitter_s, kMilli));
  texts.add("friction", or_file(ranges.friction));
  texts.add("slope, any direction, degrees", range_text(ranges.tilt_rad, kDegreesPerRad));
  texts.add("supply", share_text(ranges.supply_factor));
  texts.add("gyro white noise, deg/s/sqrt(Hz) / random walk, rad/s/sqrt(s)",
            up_to(ranges.gyro_noise_density, kDegreesPerRad) + " / " + up_to(ranges.gyro_random_walk));
  texts.add("one joint at half torque", ranges.weak_joint ? "yes" : "no");
  return texts.take();
}

std::string world_table(TableStyle style) {
  Row head{"factor"};
  std::vector<Row> rows;
  for (const std::string& name : world_names()) {
    head.push_back(name);
    const std::vector<FactorText> texts = range_texts(world_named(name));
    rows.resize(texts.size());
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (rows[i].empty()) rows[i].push_back(texts[i].factor);
      rows[i].push_back(texts[i].text);
    }
  }
  return table_text(head, rows, style);
}

std::vector<FactorText> drawn_texts(const DisturbedWorld& world, const sim_board::RobotDescription& robot) {
  Texts texts;
  add_parts(world, texts);
  texts.add_unless(world.servo_gain_divisor == 1.0, "servo gain divided by",
                   fmt::format("{:.3f}", world.servo_gain_divisor));
  texts.add_unless(world.load_friction == 0.0, "load-dependent friction, beyond the nominal",
                   fmt::format("{:.3f}", world.load_friction));
  texts.add_unless(world.motor_constant_factor == 1.0, "motor constant, %",
                   fmt::format("{:+.1f}", kPercent * (world.motor_constant_factor - 1.0)));
  texts.add_unless(world.sensor_latency_s == 0.0, "extra latency of the sensors, ms",
                   fmt::format("{:.1f}", kMilli * world.sensor_latency_s));
  texts.add_unless(world.drive_latency_ms == 0, "extra latency of the drives, ms",
                   fmt::format("{}", world.drive_latency_ms));
  texts.add_unless(world.tick_jitter_s == 0.0, "tick jitter, ms",
                   fmt::format("{:.2f}", kMilli * world.tick_jitter_s));
  if (world.friction) texts.add("friction", fmt::format("{:.2f}", *world.friction));
  texts.add_unless(
      world.tilt_rad == 0.0, "slope about x and y, degrees",
      fmt::format("{:+.2f} {:+.2f}", kDegreesPerRad * world.roll_rad(), kDegreesPerRad * world.pitch_rad()));
  texts.add_unless(world.supply_factor == 1.0, "supply, %",
                   fmt::format("{:+.1f}", kPercent * (world.supply_factor - 1.0)));
  if (world.gyro_noise_density) {
    texts.add("gyro white noise, deg/s/sqrt(Hz)",
              fmt::format("{:.5f}", kDegreesPerRad * *world.gyro_noise_density));
  }
  if (world.gyro_random_walk)
    texts.add("gyro random walk, rad/s/sqrt(s)", fmt::format("{:.2g}", *world.gyro_random_walk));
  if (world.weak_joint) texts.add("half torque", robot.joints.at(*world.weak_joint).name);
  return texts.take();
}

}  // namespace koboshi::simulation
