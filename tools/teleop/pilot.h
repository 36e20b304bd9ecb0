#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <variant>

#include "firmware/behaviour/state.h"
#include "firmware/walk/velocity.h"
#include "sim_board/scenario/scenario.h"
#include "tools/teleop/key.h"

namespace koboshi::tools {

// A push as the operator means it: ahead and to the left of the robot.
struct BodyPush {
  Eigen::Vector2d impulse_B_N_s = Eigen::Vector2d::Zero();

  // On a link of a robot that heads there, counter-clockwise from the world's x axis. A half sine of 0.1 s.
  [[nodiscard]] sim::Push on(const std::string& link, double heading_rad) const;
};

// What a key leads to: nothing, a command for the controller, a push, or the end of the run.
struct EndOfRun {};
using Order = std::variant<std::monostate, sim::Command, BodyPush, EndOfRun>;

// Makes orders of keys. Knows the velocity that it has commanded last, and neither terminal nor robot.
class Pilot {
 public:
  static constexpr std::int16_t kSpeedStep_mm_per_s = 20;
  static constexpr std::int16_t kTurnStep_mrad_per_s = 100;
  static constexpr int kPushStep_mN_s = 50;
  static constexpr int kLargestPush_mN_s = 2000;

  explicit Pilot(const walk::VelocityLimits& limits) : limits_(limits) {}

  // In this state of the controller. Off its feet the robot takes no velocity, and begins anew from zero.
  [[nodiscard]] Order press(Key key, behaviour::State state);

  const walk::Velocity& velocity() const { return velocity_; }
  double push_N_s() const { return 1e-3 * push_mN_s_; }
  // The next direction is that of a push.
  bool aims() const { return aims_; }
  // What the last key did, in a few words: "walk, 0.04 m/s forward".
  const std::string& effect() const { return effect_; }

 private:
  Order push(const Eigen::Vector2d& direction);
  Order walk();
  Order tell(const char* effect, const Order& order);
  void change_push(int by_mN_s);
  void change_velocity(Key key);

  walk::VelocityLimits limits_;
  walk::Velocity velocity_;
  // 0.17 N s/kg of koboshi's 1.2 kg.
  int push_mN_s_ = 200;
  bool aims_ = false;
  std::string effect_;
};

}  // namespace koboshi::tools
