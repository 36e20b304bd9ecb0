// Gamepads by SDL 2: https://wiki.libsdl.org/SDL2/CategoryGameController.

#include <SDL.h>

#include "studio/gamepad/gamepad.h"

namespace koboshi::studio {
namespace {

constexpr std::array<SDL_GameControllerButton, kGamepadButtons> kSdlButtons{
    SDL_CONTROLLER_BUTTON_A,
    SDL_CONTROLLER_BUTTON_B,
    SDL_CONTROLLER_BUTTON_Y,
    SDL_CONTROLLER_BUTTON_BACK,
    SDL_CONTROLLER_BUTTON_LEFTSHOULDER,
    SDL_CONTROLLER_BUTTON_RIGHTSHOULDER};

class SdlGamepads final : public Gamepads {
 public:
  SdlGamepads() = default;
  ~SdlGamepads() override {
    close();
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }

  std::optional<GamepadState> read() override {
    SDL_GameControllerUpdate();  // also finds gamepads that come and go
    if (pad_ != nullptr && SDL_GameControllerGetAttached(pad_) == SDL_FALSE) {
      close();
      return std::nullopt;  // once, so that the loss of a pad shows even if there is another one
    }
    if (pad_ == nullptr) open_first();
    if (pad_ == nullptr) return std::nullopt;
    GamepadState state;
    state.left_x = axis(SDL_CONTROLLER_AXIS_LEFTX);
    state.left_y = -axis(SDL_CONTROLLER_AXIS_LEFTY);  // SDL's points down
    state.right_x = axis(SDL_CONTROLLER_AXIS_RIGHTX);
    for (std::size_t i = 0; i < kSdlButtons.size(); ++i)
      state.pressed[i] = SDL_GameControllerGetButton(pad_, kSdlButtons[i]) != 0;
    return state;
  }

  std::string name() const override {
    const char* name = pad_ == nullptr ? nullptr : SDL_GameControllerName(pad_);
    return name == nullptr ? std::string() : name;
  }

 private:
  void open_first() {
    for (int i = 0; i < SDL_NumJoysticks() && pad_ == nullptr; ++i)
      if (SDL_IsGameController(i) == SDL_TRUE) pad_ = SDL_GameControllerOpen(i);
  }
  void close() {
    if (pad_ != nullptr) SDL_GameControllerClose(pad_);
    pad_ = nullptr;
  }
  double axis(SDL_GameControllerAxis axis) const {
    constexpr double kFull = 32767.0;
    return std::max(static_cast<double>(SDL_GameControllerGetAxis(pad_, axis)) / kFull, -1.0);
  }

  SDL_GameController* pad_ = nullptr;
};

}  // namespace

std::unique_ptr<Gamepads> open_gamepads() {
  // Qt has the window, and with it the focus; signals are the program's.
  SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
  SDL_SetMainReady();
  if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0) return nullptr;
  return std::make_unique<SdlGamepads>();
}

}  // namespace koboshi::studio
