#include "tools/motion_remote/robot_motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <thread>

#include "bus/can/source.h"
#include "firmware/app/dictionary.h"
#include "firmware/app/object_texts.h"
#include "firmware/behaviour/command.h"
#include "firmware/behaviour/state.h"
#include "firmware/canopen/frame.h"
#include "firmware/drive/configuration.h"
#include "firmware/storage/item.h"

namespace koboshi::tools {
namespace {

using behaviour::Reason;
using behaviour::State;
using Clock = std::chrono::steady_clock;

constexpr std::uint8_t kNode = drive::kControllerNodeId;
constexpr std::uint16_t kCommandId = canopen::kRpdo1Base + kNode;
constexpr std::uint16_t kValidMotionsObject = 0x2403;  // a mask of 32 motions at each sub-index
constexpr canopen::ObjectAddress kSecondMotionObject{0x2001, 10};
constexpr std::uint16_t kTelemetryId = canopen::kTpdo1Base + kNode;
// Telemetry comes each 10 ms.
constexpr auto kTelemetryTimeout = std::chrono::seconds(1);
// Cycles until the telemetry shows the outcome of a command: it is obeyed or refused when it is received, and
// the telemetry of that cycle may be under way.
constexpr int kOutcomeCycles = 3;
// Between two questions about the second motion, which is in no PDO.
constexpr auto kPollPeriod = std::chrono::milliseconds(50);

canopen::ObjectAddress object_of(std::uint16_t index, std::uint16_t number) {
  return {index, static_cast<std::uint8_t>(number + 1)};
}

std::uint32_t number_of(const std::vector<std::uint8_t>& data) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < data.size(); ++i) value |= std::uint32_t{data[i]} << (8 * i);
  return value;
}

std::string_view name_of(State state) {
  return canopen::name_of(app::kStateNames, static_cast<std::int64_t>(state));
}

std::string_view name_of(Reason reason) {
  return canopen::name_of(app::kReasonNames, static_cast<std::int64_t>(reason));
}

std::string names_of(const std::vector<RobotMotion>& motions) {
  std::string names;
  for (const RobotMotion& motion : motions)
    names += fmt::format("{}{} {}", names.empty() ? "" : ", ", motion.number, motion.name);
  return names.empty() ? "a robot that has one; it has none" : "one of " + names;
}

}  // namespace

// The controller's first TPDO.
struct RobotMotions::Telemetry {
  State state;
  Reason reason;
  std::uint8_t motion;
  Reason refusal;
};

RobotMotions::RobotMotions(sim_board::Transport& transport) : transport_(transport), sdo_(transport, kNode) {}

std::vector<RobotMotion> RobotMotions::list() {
  constexpr std::uint16_t kMaskBits = 32;
  std::vector<RobotMotion> motions;
  std::uint32_t mask = 0;
  for (std::uint16_t number = 0; number < storage::kMaxMotions; ++number) {
    if (number % kMaskBits == 0)
      mask = number_of(sdo_.read(object_of(kValidMotionsObject, number / kMaskBits)));
    if ((mask >> number % kMaskBits & 1u) == 0) continue;
    const auto name = sdo_.read(object_of(app::kMotionNameObject, number));
    motions.push_back({.number = number,
                       .name = {name.begin(), std::find(name.begin(), name.end(), 0)},
                       .crc32 = number_of(sdo_.read(object_of(app::kMotionCrcObject, number)))});
  }
  return motions;
}

std::vector<std::uint8_t> RobotMotions::download(std::uint16_t number, const bus::SdoProgress& progress) {
  return sdo_.upload(object_of(app::kMotionObject, number), progress);
}

void RobotMotions::upload(std::uint16_t number, std::span<const std::uint8_t> image,
                          const bus::SdoProgress& progress) {
  sdo_.download(object_of(app::kMotionObject, number), image, progress);
  if (!std::ranges::equal(download(number), image))
    throw std::runtime_error(fmt::format("motion {} reads back with other bytes", number));
}

std::uint16_t RobotMotions::find(std::string_view text) {
  const std::vector<RobotMotion> motions = list();
  std::uint16_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  const auto found = std::ranges::find_if(motions, [&](const RobotMotion& motion) {
    return is_number ? motion.number == number : motion.name == text;
  });
  if (found == motions.end())
    throw std::invalid_argument(
        fmt::format("found no motion {} on the robot, expected {}", text, names_of(motions)));
  return found->number;
}

std::uint16_t RobotMotions::number_for(std::string_view name) {
  std::uint16_t free = 0;
  for (const RobotMotion& motion : list()) {
    if (motion.name == name) return motion.number;
    if (motion.number == free) ++free;
  }
  if (free == storage::kMaxMotions)
    throw std::runtime_error(fmt::format("all {} numbers of motions are in use", free));
  return free;
}

RobotMotions::Telemetry RobotMotions::next_telemetry() {
  const auto deadline = Clock::now() + kTelemetryTimeout;
  while (Clock::now() < deadline) {
    const auto frame = transport_.receive();
    if (!frame) {
      bus::wait_for_frames(transport_, 1'000);
    } else if (frame->identifier == kTelemetryId && frame->size == 8 && !frame->remote) {
      return {static_cast<State>(frame->data[0]), static_cast<Reason>(frame->data[1]), frame->data[2],
              static_cast<Reason>(frame->data[7])};
    }
  }
  throw std::runtime_error("no telemetry from the controller within a second");
}

void RobotMotions::play(std::uint16_t number) {
  static_cast<void>(next_telemetry());  // the controller is there
  hal::CanFrame command{.identifier = kCommandId, .size = 3};
  command.data[0] = static_cast<std::uint8_t>(behaviour::Command::kPlay);
  command.data[1] = static_cast<std::uint8_t>(number);
  command.data[2] = static_cast<std::uint8_t>(number >> 8);
  bus::send_surely(transport_, command);
  while (transport_.receive()) {  // sent before the command
  }
  Telemetry now = next_telemetry();
  for (int cycle = 1; cycle < kOutcomeCycles; ++cycle) now = next_telemetry();
  if (now.refusal != Reason::kNone)
    throw std::runtime_error(
        fmt::format("the robot refuses in state {}: {}", name_of(now.state), name_of(now.refusal)));
  const auto second = [&] { return number_of(sdo_.read(kSecondMotionObject)) == number; };
  const bool is_second = second();
  const State began_in = now.state;
  while (is_second ? second() : now.state == State::kMotion && now.motion == number) {
    if (is_second) std::this_thread::sleep_for(kPollPeriod);
    now = next_telemetry();
  }
  const bool ended_well = now.state == State::kStanding || (is_second && now.state == began_in);
  if (!ended_well)
    throw std::runtime_error(
        fmt::format("the motion was cut off: state {}, {}", name_of(now.state), name_of(now.reason)));
}

}  // namespace koboshi::tools
