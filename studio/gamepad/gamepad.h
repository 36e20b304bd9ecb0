#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace koboshi::studio {

// The buttons with a meaning, by their places on a gamepad with four buttons at the right.
enum class GamepadButton {
  kSouth,  // A of an Xbox pad, cross of a PlayStation pad
  kEast,   // B, circle
  kNorth,  // Y, triangle
  kBack,   // View, Select, Share
  kLeftShoulder,
  kRightShoulder,
};
inline constexpr std::size_t kGamepadButtons = 6;

// Sticks and buttons at a moment. Axes -1..1: right and up are positive.
struct GamepadState {
  double left_x = 0.0;
  double left_y = 0.0;
  double right_x = 0.0;
  std::array<bool, kGamepadButtons> pressed{};  // by GamepadButton

  bool is_pressed(GamepadButton button) const { return pressed[static_cast<std::size_t>(button)]; }
};

// Access to the gamepads of this machine. The first one that is there counts; another one takes its place
// when it has gone.
class Gamepads {
 public:
  virtual ~Gamepads() = default;
  // Returns the state of the gamepad now; nothing without one.
  [[nodiscard]] virtual std::optional<GamepadState> read() = 0;
  // The name of the gamepad that was read last.
  virtual std::string name() const = 0;
};

// Returns the gamepads of this machine. Null: this program was built without SDL 2, or SDL does not start.
[[nodiscard]] std::unique_ptr<Gamepads> open_gamepads();

}  // namespace koboshi::studio
