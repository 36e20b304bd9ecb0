#include "studio/gamepad/gamepad_pilot.h"

#include <cmath>

namespace koboshi::studio {
namespace {

// Deflection beyond the dead band, -1..1, in steps of a fiftieth: the noise of a stick is no new velocity.
double deflection(double axis) {
  constexpr double kSteps = 50.0;
  const double beyond = std::abs(axis) - GamepadPilot::kDeadBand;
  if (!(beyond > 0.0)) return 0.0;
  const double share = std::min(beyond / (1.0 - GamepadPilot::kDeadBand), 1.0);
  return std::copysign(std::ceil(kSteps * share) / kSteps, axis);
}

}  // namespace

std::optional<Eigen::Vector3d> GamepadPilot::velocity_of(const GamepadState& state) const {
  const double ahead = deflection(state.left_y);
  const double right = deflection(state.left_x);
  const double clockwise = deflection(state.right_x);
  if (ahead == 0.0 && right == 0.0 && clockwise == 0.0) return std::nullopt;
  return Eigen::Vector3d(ahead * (ahead < 0.0 ? limits_.backward_m_per_s : limits_.forward_m_per_s),
                         -right * limits_.lateral_m_per_s, -clockwise * limits_.turn_rad_per_s);
}

std::vector<simulation::Command> GamepadPilot::take(const std::optional<GamepadState>& state,
                                                    std::uint64_t now_us) {
  std::vector<simulation::Command> commands;
  if (!state) {
    release();
    last_.reset();
  } else {
    take_sticks(*state);
    if (last_) take_buttons(*state, commands);
    last_ = state;
  }
  // A stop of the walk comes before the buttons' commands, and is not repeated by the button's own.
  if (const auto walk = walk_.due(now_us)) {
    const bool stops_anyway = !commands.empty() && walk->kind == simulation::Command::Kind::kStop;
    if (!stops_anyway) commands.insert(commands.begin(), *walk);
  }
  return commands;
}

void GamepadPilot::take_sticks(const GamepadState& state) {
  const auto velocity = velocity_of(state);
  if (!velocity) {
    must_release_ = false;
    walk_.release();
  } else if (!must_release_) {
    walk_.hold(*velocity);
  }
}

void GamepadPilot::take_buttons(const GamepadState& state, std::vector<simulation::Command>& commands) {
  for (const ButtonMeaning& meaning : kButtonMeanings) {
    if (!state.is_pressed(meaning.button) || last_->is_pressed(meaning.button)) continue;
    simulation::Command& command = commands.emplace_back();
    command.kind = meaning.command;
    if (meaning.command != simulation::Command::Kind::kEnable) release();
  }
}

void GamepadPilot::release() {
  walk_.release();
  must_release_ = true;
}

}  // namespace koboshi::studio
