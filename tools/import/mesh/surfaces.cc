#include "tools/import/mesh/surfaces.h"

#include <map>
#include <utility>

#include <fmt/format.h>

#include "base/text/text.h"
#include "tools/import/mesh/mesh_reader.h"
#include "tools/import/mesh/primitives.h"

namespace koboshi::tools {
namespace {

// The longest link of a robot that a table holds. A mesh that is larger is in millimetres.
constexpr double kMaxLink_m = 5.0;
constexpr double kMmInM = 0.001;

class SurfaceLoader {
 public:
  SurfaceLoader(const MeshPaths& paths, ImportReport& report) : paths_(paths), report_(report) {}

  // Returns false for a shape without a surface.
  bool load(const std::string& link, ImportedShape& shape) {
    if (shape.surface) return true;  // the reader has it
    if (shape.kind != ShapeKind::kMesh) {
      shape.surface = primitive_surface(shape.kind, shape.size_m);
      return true;
    }
    std::filesystem::path file = paths_.find(shape.uri);
    if (file.empty()) {
      file = paths_.find_by_end(shape.uri);
      if (!file.empty() && !std::exchange(warned_[shape.uri], true))
        report_.normalised.push_back(
            fmt::format("line {}: {} -> {}, because there is no such file, but this one", shape.line,
                        one_line(shape.uri), file.string()));
    }
    if (file.empty()) {
      warn_once(shape.uri, fmt::format("line {}: no file {} for link {}; name its folder with --path",
                                       shape.line, one_line(shape.uri), link));
      return false;
    }
    const MeshFile& mesh = read(file);
    if (!mesh.mesh) {
      warn_once(shape.uri, fmt::format("{}: {}; left out of link {}", file.string(), mesh.fault, link));
      return false;
    }
    shape.surface = scaled(shape.uri, *mesh.mesh, shape.scale);
    return true;
  }

 private:
  const MeshFile& read(const std::filesystem::path& file) {
    const auto [entry, is_new] = files_.try_emplace(file);
    if (is_new) entry->second = read_mesh_file(file);
    return entry->second;
  }

  std::shared_ptr<const view::Mesh> scaled(const std::string& uri, const view::Mesh& mesh,
                                           const Eigen::Vector3d& scale) {
    const auto key = std::make_pair(uri, std::array{scale.x(), scale.y(), scale.z()});
    auto& surface = scaled_[key];
    if (surface) return surface;
    auto copy = std::make_shared<view::Mesh>(mesh);
    Eigen::AlignedBox3d extent;
    for (Eigen::Vector3f& vertex : copy->vertices_m) {
      vertex = vertex.cwiseProduct(scale.cast<float>());
      extent.extend(vertex.cast<double>());
    }
    if (!extent.isEmpty() && extent.sizes().maxCoeff() > kMaxLink_m) {
      for (Eigen::Vector3f& vertex : copy->vertices_m) vertex *= static_cast<float>(kMmInM);
      report_.normalised.push_back(fmt::format("{}: a size of {:.0f} m -> read as millimetres", one_line(uri),
                                               extent.sizes().maxCoeff()));
    }
    if (scale.prod() < 0.0)  // a mirror image turns the triangles inside out
      for (auto& triangle : copy->triangles) std::swap(triangle[1], triangle[2]);
    return surface = copy;
  }

  void warn_once(const std::string& uri, const std::string& warning) {
    if (!std::exchange(warned_[uri], true)) report_.warnings.push_back(warning);
  }

  const MeshPaths& paths_;
  ImportReport& report_;
  std::map<std::filesystem::path, MeshFile> files_;
  std::map<std::pair<std::string, std::array<double, 3>>, std::shared_ptr<const view::Mesh>> scaled_;
  std::map<std::string, bool> warned_;
};

}  // namespace

void load_surfaces(ImportedRobot& robot, const MeshPaths& paths, ImportReport& report) {
  SurfaceLoader loader(paths, report);
  for (ImportedLink& link : robot.links)
    for (auto* shapes : {&link.visuals, &link.collisions})
      std::erase_if(*shapes, [&](ImportedShape& shape) { return !loader.load(link.name, shape); });
}

}  // namespace koboshi::tools
