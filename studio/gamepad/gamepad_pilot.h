#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "simulation/scenario/scenario.h"
#include "studio/gamepad/gamepad.h"
#include "studio/gamepad/held_walk.h"

namespace koboshi::studio {

// The velocities at full deflection of a stick, positive.
struct StickLimits {
  double forward_m_per_s = 0.1;
  double backward_m_per_s = 0.1;
  double lateral_m_per_s = 0.05;
  double turn_rad_per_s = 0.5;
};

// The meaning of a button, for the pilot and for users.
struct ButtonMeaning {
  GamepadButton button;
  simulation::Command::Kind command;
  std::string_view place;  // on an Xbox pad
};
inline constexpr std::array<ButtonMeaning, kGamepadButtons> kButtonMeanings{
    {{GamepadButton::kSouth, simulation::Command::Kind::kEnable, "A"},
     {GamepadButton::kEast, simulation::Command::Kind::kStop, "B"},
     {GamepadButton::kNorth, simulation::Command::Kind::kGetUp, "Y"},
     {GamepadButton::kBack, simulation::Command::Kind::kReset, "View"},
     {GamepadButton::kLeftShoulder, simulation::Command::Kind::kEmergencyStop, "LB"},
     {GamepadButton::kRightShoulder, simulation::Command::Kind::kEmergencyStop, "RB"}}};

// Translates a gamepad into commands: the left stick walks forward and to the side, the right one turns, and
// each button gives a command when it is pressed. The robot walks while a stick is outside of its dead band;
// released sticks, a lost gamepad and each button but enable end the walk. After a button, and when a gamepad
// comes, the sticks must be released once before the robot walks.
class GamepadPilot {
 public:
  // Dead band of each axis: worn sticks rest at up to 0.1, and a thumb at rest moves one a little.
  static constexpr double kDeadBand = 0.15;

  void set_limits(const StickLimits& limits) { limits_ = limits; }
  // Takes the state of the gamepad, nothing if there is none, and returns the commands that are due, in their
  // order. Times never decrease.
  [[nodiscard]] std::vector<simulation::Command> take(const std::optional<GamepadState>& state,
                                                      std::uint64_t now_us);
  // Ends the walk: it stops with the next take().
  void release();
  bool walks() const { return walk_.is_held(); }
  // The velocity that the sticks command: m/s forward and to the left, rad/s counter-clockwise. Nothing while
  // all are within their dead bands.
  [[nodiscard]] std::optional<Eigen::Vector3d> velocity_of(const GamepadState& state) const;

 private:
  void take_sticks(const GamepadState& state);
  void take_buttons(const GamepadState& state, std::vector<simulation::Command>& commands);

  StickLimits limits_;
  HeldWalk walk_;
  std::optional<GamepadState> last_;
  bool must_release_ = true;
};

}  // namespace koboshi::studio
