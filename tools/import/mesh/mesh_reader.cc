#include "tools/import/mesh/mesh_reader.h"

#include "base/text/foreign_text.h"
#include "tools/import/mesh/assimp_mesh.h"
#include "view/capture/stl.h"

namespace koboshi::tools {
namespace {

constexpr std::uintmax_t kMaxFile_bytes = std::uintmax_t{256} << 20;
constexpr std::size_t kMaxTriangles = 5'000'000;

}  // namespace

MeshFile read_mesh_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) return {.fault = "a file that cannot be read"};
  if (size > kMaxFile_bytes) return {.fault = "a mesh of more than 256 MiB"};
  const std::string extension = extension_of(file);
  MeshFile read;
  if (extension == ".stl") {
    view::StlFile stl = view::read_stl(file);
    read = {.mesh = std::move(stl.mesh), .fault = std::move(stl.fault)};
  } else if (extension == ".dae" || extension == ".obj") {
    read = read_by_assimp(file);
  } else {
    return {.fault = "a mesh of another format, expected STL, DAE or OBJ"};
  }
  if (read.mesh && read.mesh->triangles.size() > kMaxTriangles)
    return {.fault = "a mesh of more than 5,000,000 triangles"};
  if (read.mesh && read.mesh->triangles.empty()) return {.fault = "a mesh without triangles"};
  return read;
}

}  // namespace koboshi::tools
