#include "simulation/scenario/events.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/text/user_units.h"

namespace koboshi::simulation {
namespace {

constexpr NumberRange kTime_s{.min = 0.0, .max = 86400.0};

std::uint64_t read_time_us(const YamlMap& map) { return to_us(map.number("at_s", kTime_s)); }

SourcedName read_name(const YamlValue& value) { return {value.text(), value.source(), value.line()}; }

Eigen::Vector3d read_vector(const YamlMap& map, const std::string& key, double largest) {
  const std::vector<double> v = map.numbers(key, 3, {.min = -largest, .max = largest});
  return {v[0], v[1], v[2]};
}

// Reads all items of an optional list.
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

// The controller clamps targets to the limits of the joints.
std::vector<StreamedJoint> read_stream(const YamlMap& map) {
  std::vector<StreamedJoint> stream;
  if (!map.has("joints_deg")) return stream;
  for (const auto& [joint, value] : map.value("joints_deg").map().entries())
    stream.push_back({{joint, value.source(), value.line()},
                      value.number({.min = -180.0, .max = 179.9}) / kDegreesPerRad});
  return stream;
}

constexpr std::array<std::pair<const char*, Command::Kind>, 8> kVerbs{
    {{"enable", Command::Kind::kEnable},
     {"play", Command::Kind::kPlay},
     {"walk", Command::Kind::kWalk},
     {"stop", Command::Kind::kStop},
     {"stream", Command::Kind::kStream},
     {"get_up", Command::Kind::kGetUp},
     {"emergency_stop", Command::Kind::kEmergencyStop},
     {"reset", Command::Kind::kReset}}};

// Returns an error for an item without a known command, naming the key found instead.
InputError no_verb(const YamlValue& item) {
  std::vector<std::string> verbs;
  for (const auto& [verb, kind] : kVerbs) verbs.emplace_back(verb);
  for (const auto& [key, value] : item.map().entries()) {
    if (key == "at_s") continue;
    return value.error("the unknown command " + one_line(key), expected_names(key, verbs));
  }
  return item.error("a time without a command", join_alternatives(verbs));
}

Command read_command(const YamlValue& item, const std::vector<std::string>& motions) {
  const YamlMap map = item.map();
  Command command;
  command.at_us = read_time_us(map);
  const char* found = nullptr;
  for (const auto& [verb, kind] : kVerbs) {
    if (!map.has(verb)) continue;
    const YamlValue value = map.value(verb);
    if (found != nullptr)
      throw value.error(std::string(found) + " and " + verb + " in one command", "one of the two");
    found = verb;
    command.kind = kind;
    if (kind == Command::Kind::kPlay) {
      command.motion = find_motion(value, motions);
    } else if (kind == Command::Kind::kWalk) {
      command.velocity = read_velocity(value.map());
    } else if (kind == Command::Kind::kStream) {
      command.stream = read_stream(value.map());
    } else if (!value.boolean()) {
      throw value.error("true");
    }
  }
  if (found == nullptr) throw no_verb(item);
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

std::uint16_t read_identifier(const YamlValue& value) {
  return static_cast<std::uint16_t>(value.integer({.min = 0, .max = 0x7FF}));
}

// Reads a single identifier, or the first and last of a range.
void read_identifiers(const YamlMap& map, sim_board::FrameFault& frames) {
  if (!map.has("identifier")) return;
  const YamlValue value = map.value("identifier");
  if (!value.is_list()) {
    frames.first_identifier = frames.last_identifier = read_identifier(value);
    return;
  }
  const std::vector<YamlValue> bounds = value.list();
  if (bounds.size() != 2) throw value.error("one identifier, or a list of the first and the last");
  frames.first_identifier = read_identifier(bounds[0]);
  frames.last_identifier = read_identifier(bounds[1]);
  if (frames.first_identifier > frames.last_identifier)
    throw bounds[1].error("no identifier below the first");
}

void read_frames(const YamlMap& map, sim_board::FrameFault::Effect effect, Fault& fault) {
  fault.target = map.has("target") ? read_name(map.value("target")) : SourcedName{};
  fault.frames.effect = effect;
  read_identifiers(map, fault.frames);
  fault.frames.share = map.number("share", {.min = 0.0, .max = 1.0}, 1.0);
  if (map.has("count"))
    fault.frames.count = static_cast<std::uint64_t>(map.integer("count", {.min = 1, .max = 1'000'000'000}));
  if (effect == sim_board::FrameFault::Effect::kDelayed)
    fault.frames.delay_us = to_us(1e-3 * map.number("delay_ms", {.min = 0.001, .max = 10'000.0}));
}

// Reads the data bytes, or a number of zero bytes.
void read_data(const YamlMap& map, hal::CanFrame& frame) {
  if (!map.has("data")) {
    frame.size = static_cast<std::uint8_t>(map.integer("size", {.min = 0, .max = 8}, 8));
    return;
  }
  const YamlValue value = map.value("data");
  const std::vector<YamlValue> bytes = value.list();
  if (bytes.size() > frame.data.size()) throw value.error("more than 8 bytes");
  frame.size = static_cast<std::uint8_t>(bytes.size());
  std::ranges::transform(bytes, frame.data.begin(), [](const YamlValue& byte) {
    return static_cast<std::uint8_t>(byte.integer({.min = 0, .max = 0xFF}));
  });
}

void read_babble(const YamlMap& map, Fault& fault) {
  fault.babble.frame.identifier = read_identifier(map.value("identifier"));
  read_data(map, fault.babble.frame);
  if (!map.has("rate_per_s")) return;
  const double rate_per_s = map.number("rate_per_s", {.min = 1.0, .max = 20'000.0});
  fault.babble.interval_us = to_us(1.0 / rate_per_s);
}

// Reads the details of a fault other than its times.
void read_details(const YamlMap& map, Fault& fault) {
  using Effect = sim_board::FrameFault::Effect;
  switch (fault.kind) {
    case Fault::Kind::kDriveSilent:
    case Fault::Kind::kDrivePowerLoss:
    case Fault::Kind::kEncoderBreak:
    case Fault::Kind::kDriveOverheat:
      fault.target = read_name(map.value("target"));
      return;
    case Fault::Kind::kAnkleStop:
      fault.side = map.one_of("target", {"left", "right"}) == "left" ? hal::Side::kLeft : hal::Side::kRight;
      fault.target = read_name(map.value("target"));
      return;
    case Fault::Kind::kSupplyDrop:
      fault.highest_V = map.number("supply_V", {.min = 0.0, .max = 1000.0});
      return;
    case Fault::Kind::kBatteryDischarge:
      fault.open_circuit_V = map.number("open_circuit_V", {.min = 0.0, .max = 1000.0});
      fault.over_us = to_us(map.number("over_s", {.min = 0.0, .max = 86400.0}, 0.0));
      return;
    case Fault::Kind::kImuStop:
    case Fault::Kind::kControllerStop:
    case Fault::Kind::kBusUnacknowledged:
    case Fault::Kind::kBusDominant:
      return;
    case Fault::Kind::kFramesLost:
      return read_frames(map, Effect::kLost, fault);
    case Fault::Kind::kFramesCorrupted:
      return read_frames(map, Effect::kCorrupted, fault);
    case Fault::Kind::kFramesDelayed:
      return read_frames(map, Effect::kDelayed, fault);
    case Fault::Kind::kFramesDoubled:
      return read_frames(map, Effect::kDoubled, fault);
    case Fault::Kind::kBabblingNode:
      return read_babble(map, fault);
  }
}

Fault read_fault(const YamlValue& item) {
  const YamlMap map = item.map();
  Fault fault;
  fault.at_us = read_time_us(map);
  const std::string kind = map.one_of("kind", Fault::kind_names());
  fault.kind =
      static_cast<Fault::Kind>(std::ranges::find(Fault::kind_names(), kind) - Fault::kind_names().begin());
  fault.target = read_name(map.value("kind"));
  // A broken cable stays broken, an overheated winding cools at its own rate, and nobody charges the battery.
  const bool may_end = fault.kind != Fault::Kind::kEncoderBreak &&
                       fault.kind != Fault::Kind::kDriveOverheat &&
                       fault.kind != Fault::Kind::kBatteryDischarge;
  if (may_end && map.has("duration_s"))
    fault.duration_us = to_us(map.number("duration_s", {.min = 1e-6, .max = 86400.0}));
  read_details(map, fault);
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

}  // namespace koboshi::simulation
