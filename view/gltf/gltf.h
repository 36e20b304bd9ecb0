#pragma once

#include <filesystem>
#include <string>

#include "view/recording/recording.h"

namespace koboshi::view {

// Returns a recording as binary glTF 2.0 (GLB), which Blender and other programs open: ground and links with
// their visual shapes, and one animation with translation and rotation of every link at each sample, to be
// interpolated linearly. A root node turns the z-up world to glTF's y-up. asset.extras holds title, scenario,
// seed, stepper and version of the run. The plane is a square that reaches beyond the robot's path.
// Specification: https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
std::string gltf_of(const Recording& recording);

// Writes it to a file. Throws InputError unless the file's name ends in .glb, and WriteError.
void write_gltf(const Recording& recording, const std::filesystem::path& file);

}  // namespace koboshi::view
