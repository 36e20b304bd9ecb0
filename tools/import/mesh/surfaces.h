#pragma once

#include "tools/import/mesh/mesh_paths.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Sets the surface of each shape: meshes from their files, boxes, cylinders, spheres and capsules as
// triangles. A mesh that is missing or damaged is a warning, and its shape is removed. Meshes in millimetres
// are recognised by their size.
void load_surfaces(ImportedRobot& robot, const MeshPaths& paths, ImportReport& report);

}  // namespace koboshi::tools
