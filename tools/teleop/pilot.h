#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <variant>

#include "firmware/behaviour/state.h"
#include "firmware/walk/velocity.h"
#include "simulation/scenario/scenario.h"
#include "tools/teleop/key.h"

namespace koboshi::tools {

// A push in the robot's frame: forward and to the left.
struct BodyPush {
  Eigen::Vector2d impulse_B_N_s = Eigen::Vector2d::Zero();

  // Returns the push of a link, for a robot with this heading: a half sine of 0.1 s.
  [[nodiscard]] simulation::Push on(const std::string& link, double heading_rad) const;
};

// The effect of a key: none, a command for the controller, a push, or the end of the run.
struct EndOfRun {};
using Order = std::variant<std::monostate, simulation::Command, BodyPush, EndOfRun>;

// Translates keys into orders. Keeps the last commanded velocity; knows neither terminal nor robot.
class Pilot {
 public:
  static constexpr std::int16_t kSpeedStep_mm_per_s = 20;
  static constexpr std::int16_t kTurnStep_mrad_per_s = 100;
  static constexpr int kPushStep_mN_s = 50;
  static constexpr int kMaxPush_mN_s = 2000;

  explicit Pilot(const walk::VelocityLimits& limits) : limits_(limits) {}

  // Translates a key in this state of the controller. A robot that is not on its feet takes no velocity; the
  // commanded velocity then starts again from zero.
  [[nodiscard]] Order press(Key key, behaviour::State state);

  const walk::Velocity& velocity() const { return velocity_; }
  double push_N_s() const { return 1e-3 * push_mN_s_; }
  // Whether the next direction key gives a push.
  bool aims() const { return aims_; }
  // Describes the effect of the last key: "walk, 0.04 m/s forward".
  const std::string& effect() const { return effect_; }

 private:
  Order push(const Eigen::Vector2d& direction);
  Order walk();
  Order tell(const char* effect, const Order& order);
  void change_push(int by_mN_s);

  walk::VelocityLimits limits_;
  walk::Velocity velocity_;
  // 0.17 N s/kg for Koboshi's 1.2 kg.
  int push_mN_s_ = 200;
  bool aims_ = false;
  std::string effect_;
};

}  // namespace koboshi::tools
