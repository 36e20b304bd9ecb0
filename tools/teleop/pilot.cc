#include "tools/teleop/pilot.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "simulation/observe/event_words.h"

namespace koboshi::tools {
namespace {

constexpr std::uint64_t kPushDuration_us = 100'000;

std::int16_t step(std::int16_t value, int by, std::int16_t lowest, std::int16_t highest) {
  return static_cast<std::int16_t>(std::clamp<int>(value + by, lowest, highest));
}

// The effect of a key that steers: a change of velocity or, after kPush, a push.
struct Steering {
  Key key;
  std::int16_t walk::Velocity::*axis;
  int change;  // of the velocity
  double push_forward;
  double push_left;
};
constexpr Steering kSteering[] = {
    {Key::kForward, &walk::Velocity::forward_mm_per_s, Pilot::kSpeedStep_mm_per_s, 1.0, 0.0},
    {Key::kBackward, &walk::Velocity::forward_mm_per_s, -Pilot::kSpeedStep_mm_per_s, -1.0, 0.0},
    {Key::kLeft, &walk::Velocity::left_mm_per_s, Pilot::kSpeedStep_mm_per_s, 0.0, 1.0},
    {Key::kRight, &walk::Velocity::left_mm_per_s, -Pilot::kSpeedStep_mm_per_s, 0.0, -1.0},
    {Key::kTurnLeft, &walk::Velocity::turn_mrad_per_s, Pilot::kTurnStep_mrad_per_s, 0.0, 1.0},
    {Key::kTurnRight, &walk::Velocity::turn_mrad_per_s, -Pilot::kTurnStep_mrad_per_s, 0.0, -1.0},
};

simulation::Command command(simulation::Command::Kind kind) { return {.kind = kind}; }

simulation::Command walk_command(const walk::Velocity& velocity) {
  return {.kind = simulation::Command::Kind::kWalk,
          .velocity = 1e-3 * Eigen::Vector3d(velocity.forward_mm_per_s, velocity.left_mm_per_s,
                                             velocity.turn_mrad_per_s)};
}

}  // namespace

simulation::Push BodyPush::on(const std::string& link, double heading_rad) const {
  simulation::Push push;
  push.duration_us = kPushDuration_us;
  push.link.text = link;
  push.shape = simulation::Push::Shape::kHalfSine;
  // The mean of a half sine is 2/pi of its peak.
  const double peak_per_impulse_per_s = 0.5 * std::numbers::pi / (1e-6 * kPushDuration_us);
  push.force_W_N.head<2>() = peak_per_impulse_per_s * (Eigen::Rotation2Dd(heading_rad) * impulse_B_N_s);
  return push;
}

Order Pilot::press(Key key, behaviour::State state) {
  using Kind = simulation::Command::Kind;
  const bool on_its_feet = state == behaviour::State::kStanding || state == behaviour::State::kWalking;
  if (!on_its_feet) velocity_ = {};
  const bool aimed = std::exchange(aims_, key == Key::kPush);
  const auto* steering = std::ranges::find(kSteering, key, &Steering::key);
  if (steering != std::end(kSteering)) {
    if (aimed) return push({steering->push_forward, steering->push_left});
    if (!on_its_feet) return tell("nothing: it takes a velocity when it stands or walks only", {});
    const walk::Velocity before = velocity_;
    std::int16_t& value = velocity_.*steering->axis;
    value =
        step(value, steering->change, limits_.lowest().*steering->axis, limits_.highest().*steering->axis);
    const Order order = walk();
    if (velocity_ == before) effect_ += ", the limit";
    return order;
  }
  switch (key) {
    case Key::kGo:
      return walk();
    case Key::kStop:
      velocity_ = {};
      return tell("stop: back to the stand", command(Kind::kStop));
    case Key::kPush:
      effect_ = fmt::format("push with {:.2f} N s: now a direction", push_N_s());
      return {};
    case Key::kPushMore:
      change_push(kPushStep_mN_s);
      return {};
    case Key::kPushLess:
      change_push(-kPushStep_mN_s);
      return {};
    case Key::kEnable:
      return tell("enable the drives", command(Kind::kEnable));
    case Key::kGetUp:
      return tell("get up", command(Kind::kGetUp));
    case Key::kEmergencyStop:
      velocity_ = {};
      return tell("emergency stop", command(Kind::kEmergencyStop));
    case Key::kReset:
      return tell("reset: end of fault or emergency stop", command(Kind::kReset));
    case Key::kEnd:
      return tell("end of the run", EndOfRun{});
    default:
      return {};
  }
}

Order Pilot::tell(const char* effect, const Order& order) {
  effect_ = effect;
  return order;
}

Order Pilot::walk() {
  effect_ = "walk, " + simulation::velocity_text(velocity_);
  return walk_command(velocity_);
}

Order Pilot::push(const Eigen::Vector2d& direction) {
  effect_ = fmt::format("push {} with {:.2f} N s",
                        simulation::direction_text({direction.x(), direction.y(), 0.0}, 0.0), push_N_s());
  return BodyPush{push_N_s() * direction};
}

void Pilot::change_push(int by_mN_s) {
  push_mN_s_ = std::clamp(push_mN_s_ + by_mN_s, kPushStep_mN_s, kMaxPush_mN_s);
  effect_ = fmt::format("the next push has {:.2f} N s", push_N_s());
}

}  // namespace koboshi::tools
