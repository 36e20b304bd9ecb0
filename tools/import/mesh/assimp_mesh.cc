#include "tools/import/mesh/assimp_mesh.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>

#include "base/text/text.h"
#include "tools/import/mesh/limited_child.h"

namespace koboshi::tools {
namespace {

constexpr ChildLimits kLimits{.processor_s = 5, .memory_bytes = std::size_t{2} << 30};

void add_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& X_parent, view::Mesh& mesh) {
  const aiMatrix4x4 X = X_parent * node.mTransformation;
  for (unsigned int i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[i]];
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    for (unsigned int v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D vertex = X * part.mVertices[v];
      mesh.vertices_m.emplace_back(static_cast<float>(vertex.x), static_cast<float>(vertex.y),
                                   static_cast<float>(vertex.z));
    }
    for (unsigned int f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices == 3)
        mesh.triangles.push_back(
            {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
  }
  for (unsigned int i = 0; i < node.mNumChildren; ++i) add_node(scene, *node.mChildren[i], X, mesh);
}

template <typename T>
void append(std::string& bytes, const std::vector<T>& values) {
  const std::uint64_t count = values.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
}

template <typename T>
bool take(std::string_view& bytes, std::vector<T>& values) {
  std::uint64_t count = 0;
  if (bytes.size() < sizeof count) return false;
  std::memcpy(&count, bytes.data(), sizeof count);
  bytes.remove_prefix(sizeof count);
  if (count > bytes.size() / sizeof(T)) return false;
  values.resize(count);
  std::memcpy(static_cast<void*>(values.data()), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
  return true;
}

// In the child: 'm' and the mesh, or 'e' and the fault.
std::string read_in_child(const std::filesystem::path& file) {
  Assimp::Importer importer;
  // A node's transformations are applied here, and with them the unit and the upward axis of the file: Assimp
  // turns Collada files to y up in the transformation of the root.
  const aiScene* const scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices);
  if (scene == nullptr || scene->mRootNode == nullptr) return "e" + one_line(importer.GetErrorString());
  aiMatrix4x4 X_up;
  if (file.extension() == ".dae" || file.extension() == ".DAE")
    X_up = aiMatrix4x4(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);  // y up to z up
  view::Mesh mesh;
  add_node(*scene, *scene->mRootNode, X_up, mesh);
  std::string bytes = "m";
  append(bytes, mesh.vertices_m);
  append(bytes, mesh.triangles);
  return bytes;
}

bool is_sound(const view::Mesh& mesh) {
  for (const Eigen::Vector3f& vertex : mesh.vertices_m)
    if (!vertex.allFinite()) return false;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t index : triangle)
      if (index >= mesh.vertices_m.size()) return false;
  return true;
}

}  // namespace

MeshFile read_by_assimp(const std::filesystem::path& file) {
  const ChildResult result = run_in_child(kLimits, [&file] { return read_in_child(file); });
  if (!result.fault.empty()) return {.fault = "Assimp, which reads this file, " + result.fault};
  std::string_view bytes = result.output;
  if (bytes.starts_with('e'))
    return {.fault = "a file that Assimp cannot read: " + std::string(bytes.substr(1))};
  bytes.remove_prefix(1);
  view::Mesh mesh;
  if (!take(bytes, mesh.vertices_m) || !take(bytes, mesh.triangles) || !is_sound(mesh))
    return {.fault = "a mesh with vertices that are no finite numbers"};
  return {.mesh = std::move(mesh)};
}

}  // namespace koboshi::tools
