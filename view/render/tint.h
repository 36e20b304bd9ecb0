#pragma once

#include <Eigen/Core>

#include "view/recording/recording.h"

namespace koboshi::view {

// A colour that is mixed with the own one of a link.
struct Tint {
  Colour colour{};
  float share = 0.0F;  // 0..1; 0: the link's own colour alone
};

// The linear light of an sRGB colour (IEC 61966-2-1), red, green and blue in 0..1.
Eigen::Vector3f linear_light(const Colour& colour);
// The same of a colour with a tint; light adds, so that they are mixed in linear light.
Eigen::Vector3f linear_light(const Colour& own, const Tint& tint);

}  // namespace koboshi::view
