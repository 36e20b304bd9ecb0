#include <Eigen/Geometry>
#include <set>

#include <fmt/format.h>

#include "tools/robot_file/check/checked_model.h"

namespace koboshi::tools {
namespace {

using simulation::Severity;

constexpr double kFarMesh = 8.0;            // sizes of the robot: a mesh in millimetres has a thousand
constexpr double kSmallMesh = 1.0 / 400.0;  // a mesh that is scaled twice

// Faults of the file itself, once for all visuals that show it.
void check_file(CheckedModel& model, const ModelPlace& place, const std::string& file,
                const MeshFaults& faults) {
  if (faults.open_edges > 0)
    model.warn("R004", place, fmt::format("{} with {} open edges", file, faults.open_edges),
               "a closed surface", "Close the mesh in a modeller: shadows and pictures show its holes.");
  if (faults.inverted)
    model.warn("R005", place, fmt::format("{} with triangles that face inwards", file),
               "corners counter-clockwise as seen from outside", "Turn the normals of the mesh.");
}

void check_size(CheckedModel& model, const ModelPlace& place, const sim_board::MeshDescription& description,
                const view::Mesh& mesh, double height_m) {
  if (height_m <= 0.0) return;
  Eigen::AlignedBox3d extent;
  for (const Eigen::Vector3f& vertex : mesh.vertices_m)
    extent.extend(description.X_LG * vertex.cast<double>().cwiseProduct(description.scale));
  const double size_m = extent.isEmpty() ? 0.0 : extent.sizes().maxCoeff();
  const bool is_far = size_m > kFarMesh * height_m;
  if (!is_far && size_m >= kSmallMesh * height_m) return;
  model.warn("R006", place,
             fmt::format("{} with a size of {:.3g} m", description.file.filename().string(), size_m),
             fmt::format("{:.2g} to {:.2g} m on this robot", kSmallMesh * height_m, kFarMesh * height_m),
             is_far ? "A mesh in millimetres needs <scale>0.001 0.001 0.001</scale>."
                    : "A mesh in metres needs no scale.");
}

}  // namespace

void check_meshes(CheckedModel& model, double height_m) {
  std::set<std::filesystem::path> files;
  for (const sim_board::LinkDescription& link : model.robot.links) {
    for (const sim_board::MeshDescription& description : link.meshes) {
      const ModelPlace& place = model.places.of("link", link.name, description.name);
      const MeshStore::Entry& entry = model.meshes.of(description.file);
      const std::string file = description.file.filename().string();
      if (!entry.stl.mesh) {
        model.add("R010", entry.stl.is_damaged ? Severity::kError : Severity::kWarning, place,
                  file + ", which cannot be shown: " + entry.stl.fault, "an STL file, binary or ASCII",
                  "Export the mesh as STL again.");
        continue;
      }
      if (files.insert(description.file).second) check_file(model, place, file, entry.faults);
      check_size(model, place, description, *entry.stl.mesh, height_m);
    }
  }
}

}  // namespace koboshi::tools
