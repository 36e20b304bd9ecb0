#pragma once

#include <memory>

#include "tools/import/robot/imported_robot.h"

namespace koboshi::tools {

// Returns the surface of a box, cylinder, sphere or capsule as triangles that face outwards. `size_m` is that
// of ImportedShape.
[[nodiscard]] std::shared_ptr<const view::Mesh> primitive_surface(ShapeKind kind,
                                                                  const Eigen::Vector3d& size_m);

}  // namespace koboshi::tools
