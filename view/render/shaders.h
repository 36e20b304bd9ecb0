#pragma once

#include "view/render/gl.h"

namespace koboshi::view {

// Sources of the shaders, GLSL 3.30. Light is computed in linear colour; results are sRGB, so the framebuffer
// need not convert.

// A gradient over the whole picture.
ShaderSources background_shader();
// Robot and ground, lit: hemisphere, key light with a shadow, dimmed light of the camera, dark ground under
// near links.
ShaderSources surface_shader();
// Depth alone, for the shadow of the key light.
ShaderSources depth_shader();
// How near the links are to the ground: exp(-height / kProximity_m), seen from above.
ShaderSources proximity_shader();
// Coloured marks.
ShaderSources mark_shader();

inline constexpr float kProximity_m = 0.025F;

}  // namespace koboshi::view
