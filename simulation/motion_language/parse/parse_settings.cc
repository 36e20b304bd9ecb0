#include "simulation/motion_language/parse/parse_settings.h"

#include <algorithm>
#include <cmath>

#include "simulation/motion_language/parse/codes.h"

namespace koboshi::simulation {
namespace {

constexpr double kAngleUnits = 1 << 16;  // per turn
constexpr double kGainUnits = 1 << 12;

// Converts an angle to 2^-16 turn, saturated.
std::int16_t angle_units(double degrees) {
  const long units = std::lround(degrees / 360.0 * kAngleUnits);
  return static_cast<std::int16_t>(std::clamp(units, -32'768L, 32'767L));
}

// Returns the effect of mirroring on a source: rates and angles about x and z change their sign.
int mirror_sign_of_source(std::size_t source) { return source == 1 || source == 4 ? 1 : -1; }

}  // namespace

std::optional<std::uint32_t> SettingParser::joints(const YamlNode& node, const std::string& name) {
  const std::uint32_t mask = joints_.mask(name);
  const Place place = node.key == name ? Reader::key_place(node) : Reader::value_place(node);
  if (mask == 0) {
    reader_.error(code::kUnknownJoint, place, "the joint '" + one_line(name) + "'",
                  "a joint or group of " + joints_.robot().robot, did_you_mean(name, joints_.all(true)));
    return std::nullopt;
  }
  if ((mask & ~allowed_) != 0) {
    reader_.error(code::kJointNotListed, place, "the joint '" + name + "'",
                  "a joint of the list `joints` of this file");
    return std::nullopt;
  }
  return mask;
}

template <typename Share>
bool SettingParser::shares(const YamlNode& value, const std::string& name, std::vector<Share>& settings) {
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  std::uint32_t given = 0;
  for (const YamlNode& item : value.items) {
    const auto mask = joints(item, item.key);
    const auto percent = reader_.integer(item, {.min = Share::kMin, .max = Share::kMax});
    if (!mask || !percent) continue;
    if ((given & *mask) != 0) {
      reader_.error(code::kContradiction, Reader::key_place(item),
                    "a second " + name + " for a joint of " + item.key, "one for each joint");
      continue;
    }
    given |= *mask;
    const auto same = std::find_if(settings.begin(), settings.end(),
                                   [&](const Share& other) { return other.percent == *percent; });
    if (same != settings.end()) {
      same->joints |= *mask;
    } else {
      settings.push_back({.percent = static_cast<std::uint8_t>(*percent), .joints = *mask});
    }
  }
  if (settings.empty() && reader_.diagnostics().error_count() == errors)
    reader_.bad_value(value, "joints with their " + name);
  return reader_.diagnostics().error_count() == errors;
}

template bool SettingParser::shares(const YamlNode&, const std::string&, std::vector<motion::Stiffness>&);
template bool SettingParser::shares(const YamlNode&, const std::string&, std::vector<motion::Gain>&);

bool SettingParser::torque_off(const YamlNode& value, std::vector<motion::Stiffness>& settings) {
  if (!reader_.is_list(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  motion::Stiffness off{.percent = 0};
  for (const YamlNode& item : value.items) {
    const auto name = reader_.text(item);
    if (name) off.joints |= joints(item, *name).value_or(0);
  }
  if (value.items.empty()) reader_.bad_value(value, "at least one joint");
  settings.push_back(off);
  return reader_.diagnostics().error_count() == errors;
}

bool SettingParser::windows(const YamlNode& value, std::uint32_t time_us,
                            std::vector<motion::Window>& windows) {
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  const NumberRange range{.min = 0.0, .max = time_us * 1e-6};
  std::uint32_t given = 0;
  for (const YamlNode& item : value.items) {
    const auto mask = joints(item, item.key);
    if (!reader_.is_list(item) || !mask) continue;
    if (item.items.size() != 2) {
      reader_.bad_value(item, "a list of two times in s");
      continue;
    }
    const auto from_s = reader_.number(item.items[0], range);
    const auto to_s = reader_.number(item.items[1], range);
    if (!from_s || !to_s) continue;
    const auto share = [&](double time_s) {
      return std::lround(time_s * 1e6 / time_us * motion::Window::kWhole);
    };
    if (share(*from_s) >= share(*to_s)) {
      reader_.bad_value(item, "an end that is later than the beginning by 1/4096 of the move");
      continue;
    }
    if ((given & *mask) != 0) {
      reader_.error(code::kContradiction, Reader::key_place(item), "a second time for a joint of " + item.key,
                    "one for each joint");
      continue;
    }
    given |= *mask;
    const motion::Window window{.start = static_cast<std::uint16_t>(share(*from_s)),
                                .end = static_cast<std::uint16_t>(share(*to_s)),
                                .joints = *mask};
    const auto same = std::ranges::find_if(windows, [&](const motion::Window& other) {
      return other.start == window.start && other.end == window.end;
    });
    if (same != windows.end()) {
      same->joints |= *mask;
    } else {
      windows.push_back(window);
    }
  }
  if (windows.size() > motion::Move::kMaxWindows) reader_.bad_value(value, "at most 4 different times");
  if (value.items.empty()) reader_.bad_value(value, "joints with the times in which they turn");
  return reader_.diagnostics().error_count() == errors;
}

// Accepts the limits of an image, whose bounds are 1 and 15 degrees after rounding.
std::optional<double> SettingParser::mix_limit_deg(const YamlNode& node) {
  const auto number = reader_.number(node, {.min = 0.0, .max = 90.0});
  if (!number) return std::nullopt;
  const std::int16_t units = angle_units(*number);
  if (units >= motion::Mix::kMinLimit && units <= motion::Mix::kMaxLimit) return number;
  reader_.bad_value(node, "a number from 1 to 15");
  return std::nullopt;
}

bool SettingParser::mix(const YamlNode& value, std::vector<motion::Mix>& settings) {
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  for (const YamlNode& item : value.items) {
    const auto left = joints_.find_left(item.key);
    if (!joints_.find(item.key) && !left && joints_.mask(item.key) != 0) {
      reader_.error(code::kUnknownJoint, Reader::key_place(item), "the group '" + item.key + "'",
                    "joints, each with its gains");
      continue;
    }
    const auto mask = joints(item, item.key);
    if (!mask || !reader_.is_map(item)) continue;
    std::vector<std::string> known(kMixSources.begin(), kMixSources.end());
    known.emplace_back("limit_deg");
    reader_.check_keys(item, known);
    // Gains of zero remove corrections and need no limit.
    const bool removes = std::all_of(item.items.begin(), item.items.end(),
                                     [](const YamlNode& entry) { return parse_number(entry.scalar) == 0.0; });
    const YamlNode* limit = removes ? nullptr : reader_.require(item, "limit_deg", "a number from 1 to 15");
    const auto limit_deg = removes ? std::optional(0.0) : limit ? mix_limit_deg(*limit) : std::nullopt;
    for (std::size_t source = 0; source < kMixSources.size() && limit_deg; ++source) {
      const YamlNode* node = item.find(std::string(kMixSources[source]));
      const auto gain =
          node ? reader_.number(*node, {.min = -8.0, .max = 32'767.0 / kGainUnits}) : std::nullopt;
      if (!gain) continue;
      const auto gain_raw = static_cast<std::int16_t>(std::lround(*gain * kGainUnits));
      for (std::size_t joint = 0; joint < joints_.count(); ++joint) {
        if ((*mask >> joint & 1u) == 0) continue;
        const bool is_image = left && joint == joints_.mirror(*left) && joint != *left;
        const int sign = is_image ? joints_.mirror_sign(*left) * mirror_sign_of_source(source) : 1;
        settings.push_back({.source = static_cast<motion::MixSource>(source),
                            .joint = static_cast<std::uint8_t>(joint),
                            .gain = static_cast<std::int16_t>(std::min(sign * gain_raw, 32'767)),
                            .limit = static_cast<std::uint16_t>(angle_units(*limit_deg))});
      }
    }
  }
  if (settings.empty() && reader_.diagnostics().error_count() == errors)
    reader_.bad_value(value, "joints with their gains, or none");
  return reader_.diagnostics().error_count() == errors;
}

bool SettingParser::lean(const YamlNode& value, std::optional<motion::LeanDeclaration>& lean) {
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  reader_.check_keys(value, {"pitch_deg", "roll_deg"});
  motion::LeanDeclaration setting;
  if (const YamlNode* pitch = value.find("pitch_deg"))
    setting.pitch = angle_units(reader_.number(*pitch, {.min = -180.0, .max = 180.0}).value_or(0.0));
  if (const YamlNode* roll = value.find("roll_deg"))
    setting.roll = angle_units(reader_.number(*roll, {.min = -180.0, .max = 180.0}).value_or(0.0));
  lean = setting;
  return reader_.diagnostics().error_count() == errors;
}

}  // namespace koboshi::simulation
