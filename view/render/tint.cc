#include "view/render/tint.h"

#include <cmath>

namespace koboshi::view {

Eigen::Vector3f linear_light(const Colour& colour) {
  const auto channel = [](float value) {
    return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
  };
  return {channel(colour.red), channel(colour.green), channel(colour.blue)};
}

Eigen::Vector3f linear_light(const Colour& own, const Tint& tint) {
  return (1.0F - tint.share) * linear_light(own) + tint.share * linear_light(tint.colour);
}

}  // namespace koboshi::view
