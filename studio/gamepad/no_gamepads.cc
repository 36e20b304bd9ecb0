// Stands for sdl_gamepads.cc where SDL 2 is not installed.

#include "studio/gamepad/gamepad.h"

namespace koboshi::studio {

std::unique_ptr<Gamepads> open_gamepads() { return nullptr; }

}  // namespace koboshi::studio
