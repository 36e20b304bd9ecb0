// The access to gamepads, with SDL's virtual joystick in the place of a device.

#include <SDL.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "studio/gamepad/gamepad.h"

namespace koboshi::studio {
namespace {

// A pad that is plugged in as long as it lives.
class VirtualPad {
 public:
  VirtualPad()
      : index_(SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX,
                                         SDL_CONTROLLER_BUTTON_MAX, 0)),
        joystick_(SDL_JoystickOpen(index_)) {}
  ~VirtualPad() {
    const SDL_JoystickID id = SDL_JoystickInstanceID(joystick_);
    SDL_JoystickClose(joystick_);
    for (int i = 0; i < SDL_NumJoysticks(); ++i)
      if (SDL_JoystickGetDeviceInstanceID(i) == id) SDL_JoystickDetachVirtual(i);
  }
  VirtualPad(const VirtualPad&) = delete;
  VirtualPad& operator=(const VirtualPad&) = delete;

  void set_axis(SDL_GameControllerAxis axis, Sint16 value) {
    ASSERT_EQ(SDL_JoystickSetVirtualAxis(joystick_, axis, value), 0) << SDL_GetError();
  }
  void press(SDL_GameControllerButton button, bool down) {
    ASSERT_EQ(SDL_JoystickSetVirtualButton(joystick_, button, down ? SDL_PRESSED : SDL_RELEASED), 0);
  }

 private:
  int index_;
  SDL_Joystick* joystick_;
};

TEST(SdlGamepads, ReadsSticksAndButtonsOfAVirtualPadThatComesAndGoes) {
  const std::unique_ptr<Gamepads> pads = open_gamepads();
  ASSERT_NE(pads, nullptr) << SDL_GetError();
  if (SDL_NumJoysticks() > 0) GTEST_SKIP() << "a gamepad is plugged in here";
  EXPECT_FALSE(pads->read());
  {
    VirtualPad pad;
    auto state = pads->read();
    ASSERT_TRUE(state);
    EXPECT_FALSE(pads->name().empty());
    EXPECT_NEAR(state->left_x, 0.0, 0.001);
    pad.set_axis(SDL_CONTROLLER_AXIS_LEFTY, -32768);  // up
    pad.set_axis(SDL_CONTROLLER_AXIS_LEFTX, 16384);
    pad.set_axis(SDL_CONTROLLER_AXIS_RIGHTX, -32768);
    pad.press(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
    state = pads->read();
    ASSERT_TRUE(state);
    EXPECT_NEAR(state->left_y, 1.0, 0.001);
    EXPECT_NEAR(state->left_x, 0.5, 0.001);
    EXPECT_EQ(state->right_x, -1.0);
    EXPECT_TRUE(state->is_pressed(GamepadButton::kRightShoulder));
    EXPECT_EQ(std::ranges::count(state->pressed, true), 1);
  }
  EXPECT_FALSE(pads->read());
  EXPECT_FALSE(pads->read());
  const VirtualPad again;
  EXPECT_TRUE(pads->read());
}

}  // namespace
}  // namespace koboshi::studio
