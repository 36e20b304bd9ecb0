#include "tools/teleop/status.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <string_view>

#include "base/text/user_units.h"
#include "firmware/app/controller_objects.h"
#include "simulation/observe/event_words.h"
#include "simulation/observe/posture.h"
#include "tools/teleop/map.h"

namespace koboshi::tools {
namespace {
constexpr std::size_t kColumns = 80;
constexpr std::size_t kMapLine = 2;

constexpr std::string_view kKeys[] = {
    "up, down      faster ahead, back        space  stop: back to the stand",
    "left, right   turn                      g      go: walk, at first in place",
    "a, d or , .   to the left, right        p      push, then a direction; + - size",
    "e  emergency stop    r  reset    n  enable    u  get up   q or Ctrl-C  end",
};

template <typename T>
std::string_view name(std::span<const canopen::ValueName> names, T value) {
  return canopen::name_of(names, static_cast<std::int64_t>(value));
}

std::string time_text(const TeleopStatus& status) {
  return fmt::format("{:.2f} s, {:.2f} x real time, {} overruns, {} ms at most", status.simulated_s,
                     status.real_time_factor, status.overruns, status.largest_delay_us / 1000);
}

// The true lean of the trunk, then the state and the reason of the controller.
std::string state_text(const TeleopStatus& status) {
  std::string text;
  if (status.tilt_rad > simulation::kFallen_rad) {
    text = "LIES; ";
  } else if (status.tilt_rad > simulation::kUpAgain_rad) {
    text = fmt::format("leans by {:.0f} degrees; ", kDegreesPerRad * status.tilt_rad);
  }
  if (simulation::has_not_noticed(status.said.state, status.tilt_rad)) return text + simulation::kNotNoticed;
  text += simulation::name_of(status.said.state) + ", by " + simulation::name_of(status.said.reason);
  if (status.said.drive_fault != drive::DriveFault::kNone)
    text += fmt::format(", drive {}", name(app::kDriveFaultNames, status.said.drive_fault));
  return text;
}

std::string axes_text(const TeleopStatus::Velocity& velocity) {
  return fmt::format("ahead {:+.2f} m/s, left {:+.2f} m/s, turn {:+.2f} rad/s", velocity.forward_m_per_s,
                     velocity.left_m_per_s, velocity.turn_rad_per_s);
}

std::string attitude_text(const TeleopStatus& status) {
  return fmt::format("roll {:+.1f}, pitch {:+.1f} degrees", kDegreesPerRad * status.said.roll_rad,
                     kDegreesPerRad * status.said.pitch_rad);
}

std::string place_text(const TeleopStatus& status) {
  return fmt::format("x {:+.2f} m, y {:+.2f} m, heading {:+.0f} degrees", status.place.x(), status.place.y(),
                     kDegreesPerRad * status.place.z());
}

std::string load_text(const TeleopStatus& status) {
  std::string text =
      fmt::format("left {:.1f} N, right {:.1f} N", status.said.foot_load_N[0], status.said.foot_load_N[1]);
  if (status.held) text += ", held by the stand";
  if (status.falls > 0) text += ", " + simulation::count_text(status.falls, "fall");
  return text;
}

std::string zmp_text(const TeleopStatus& status) {
  const auto& zmp = status.said.zmp;
  if (!zmp.valid) return "none: no foot carries enough";
  std::string text = fmt::format("{:+.0f}, {:+.0f} mm on the {} sole", kMmPerM * zmp.x_m, kMmPerM * zmp.y_m,
                                 zmp.frame == hal::Side::kLeft ? "left" : "right");
  if (status.zmp_margin_m) text += fmt::format(", true margin {:.0f} mm", kMmPerM * *status.zmp_margin_m);
  return text;
}

std::string com_text(const TeleopStatus& status) {
  if (!status.said.zmp.valid) return "";
  const auto& com_S_m = status.said.com_S_m;
  return fmt::format("{:+.0f}, {:+.0f}, {:+.0f} mm from there", kMmPerM * com_S_m[0], kMmPerM * com_S_m[1],
                     kMmPerM * com_S_m[2]);
}

}  // namespace

std::vector<std::string> status_lines(const TeleopStatus& status) {
  std::vector<std::string> lines;
  const auto add = [&](std::string_view label, const std::string& text) {
    lines.push_back(fmt::format("{:<10}  {}", label, text));
  };
  lines.push_back(fmt::format("koboshi, driven by keys: {}{}", status.scenario,
                              status.bus.empty() ? "" : ", CAN bus on " + status.bus));
  lines.emplace_back();
  add("time", time_text(status));
  add("state", state_text(status));
  add("commanded", axes_text(status.commanded));
  add("measured", axes_text(status.measured));
  add("place", place_text(status));
  add("attitude", attitude_text(status));
  add("ZMP", zmp_text(status));
  add("CoM", com_text(status));
  add("load", load_text(status));
  add("supply", status.supply_V ? fmt::format("{:.2f} V at the lowest drive", *status.supply_V) : "");
  add("push", fmt::format("{:.2f} N s{}", status.push_N_s, status.aims ? ", where to?" : ""));
  add("last key", status.last_key + (status.effect.empty() ? "" : ": " + status.effect));
  add("command", status.last_command);
  add("event", status.last_event);
  if (!status.page.empty()) add("page", status.page);
  // Below the title, right of the numbers.
  put_beside(lines, kMapLine, kColumns - TrailMap::kColumns, status.map);
  lines.emplace_back();
  lines.insert(lines.end(), std::begin(kKeys), std::end(kKeys));
  for (std::string& line : lines) line.resize(std::min(line.size(), kColumns));
  return lines;
}

std::string screen_of(const std::vector<std::string>& lines, std::size_t rows) {
  std::string screen;
  for (std::size_t row = 0; row < std::min(rows, lines.size()); ++row)
    screen += fmt::format("\x1B[{};1H{}\x1B[K", row + 1, lines[row]);
  return screen + "\x1B[J";
}

}  // namespace koboshi::tools
