#include "sim_board/scenario/events.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace koboshi::sim {
namespace {

constexpr NumberRange kTime_s{.min = 0.0, .max = 86400.0};

std::uint64_t read_time_us(const YamlMap& map) { return to_us(map.number("at_s", kTime_s)); }

SourcedName read_name(const YamlValue& value) { return {value.text(), value.source(), value.line()}; }

Eigen::Vector3d read_vector(const YamlMap& map, const std::string& key, double largest) {
  const std::vector<double> v = map.numbers(key, 3, {.min = -largest, .max = largest});
  return {v[0], v[1], v[2]};
}

// Reads every item of a list that may be missing.
template <typename Event, typename Read>
std::vector<Event> read_events(const YamlMap& root, const std::string& key, const Read& read) {
  std::vector<Event> events;
  if (!root.has(key)) return events;
  for (const YamlValue& item : root.list(key)) events.push_back(read(item));
  std::ranges::stable_sort(events, {}, &Event::at_us);
  return events;
}

std::size_t find_motion(const YamlValue& value, const std::vector<std::string>& motions) {
  if (motions.empty())
    throw value.error("a motion to play, but the scenario has none",
                      "a file under the key motions, or a gait");
  const std::string name = value.one_of(motions);
  return static_cast<std::size_t>(std::ranges::find(motions, name) - motions.begin());
}

Eigen::Vector3d read_velocity(const YamlMap& map) {
  constexpr NumberRange kSpeed{.min = -2.0, .max = 2.0};
  return {map.number("forward_m_per_s", kSpeed, 0.0), map.number("left_m_per_s", kSpeed, 0.0),
          map.number("turn_rad_per_s", {.min = -6.0, .max = 6.0}, 0.0)};
}

Command read_command(const YamlValue& item, const std::vector<std::string>& motions) {
  static const std::array<std::pair<std::string, Command::Kind>, 6> kVerbs{
      {{"enable", Command::Kind::kEnable},
       {"play", Command::Kind::kPlay},
       {"walk", Command::Kind::kWalk},
       {"stop", Command::Kind::kStop},
       {"emergency_stop", Command::Kind::kEmergencyStop},
       {"reset", Command::Kind::kReset}}};
  const YamlMap map = item.map();
  Command command;
  command.at_us = read_time_us(map);
  int verbs = 0;
  for (const auto& [verb, kind] : kVerbs) {
    if (!map.has(verb)) continue;
    ++verbs;
    command.kind = kind;
    const YamlValue value = map.value(verb);
    if (kind == Command::Kind::kPlay) {
      command.motion = find_motion(value, motions);
    } else if (kind == Command::Kind::kWalk) {
      command.velocity = read_velocity(value.map());
    } else if (!value.boolean()) {
      throw value.error("true");
    }
  }
  if (verbs != 1) {
    throw item.error("a command with " + std::to_string(verbs) + " verbs",
                     "just one of enable, play, walk, stop, emergency_stop or reset");
  }
  return command;
}

Push read_push(const YamlValue& item) {
  const YamlMap map = item.map();
  Push push;
  push.at_us = read_time_us(map);
  push.duration_us = to_us(map.number("duration_s", {.min = 1e-6, .max = 3600.0}));
  push.link = read_name(map.value("link"));
  push.force_W_N = read_vector(map, "force_N", 10000.0);
  if (map.has("at_m")) push.p_L_m = read_vector(map, "at_m", 10.0);
  const bool half_sine = map.one_of("shape", {"rectangle", "half-sine"}, "rectangle") == "half-sine";
  push.shape = half_sine ? Push::Shape::kHalfSine : Push::Shape::kRectangle;
  return push;
}

Fault read_fault(const YamlValue& item) {
  static const std::vector<std::string> kKinds{"drive_silent", "drive_power_loss", "imu_stop",
                                               "ankle_stop",   "controller_stop",  "bus_unacknowledged"};
  const YamlMap map = item.map();
  Fault fault;
  fault.at_us = read_time_us(map);
  const std::string kind = map.one_of("kind", kKinds);
  fault.kind = static_cast<Fault::Kind>(std::ranges::find(kKinds, kind) - kKinds.begin());
  fault.target = read_name(map.value("kind"));
  if (fault.kind == Fault::Kind::kDriveSilent || fault.kind == Fault::Kind::kDrivePowerLoss) {
    fault.target = read_name(map.value("target"));
  }
  if (fault.kind == Fault::Kind::kAnkleStop) {
    fault.side = map.one_of("target", {"left", "right"}) == "left" ? hal::Side::kLeft : hal::Side::kRight;
    fault.target = read_name(map.value("target"));
  }
  return fault;
}

}  // namespace

std::uint64_t to_us(double time_s) { return static_cast<std::uint64_t>(std::llround(time_s * 1e6)); }

std::vector<Command> read_commands(const YamlMap& root, const std::vector<std::string>& motions) {
  return read_events<Command>(root, "commands",
                              [&](const YamlValue& item) { return read_command(item, motions); });
}

std::vector<Push> read_pushes(const YamlMap& root) { return read_events<Push>(root, "pushes", read_push); }

std::vector<Fault> read_faults(const YamlMap& root) { return read_events<Fault>(root, "faults", read_fault); }

}  // namespace koboshi::sim
