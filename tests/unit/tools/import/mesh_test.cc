#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "tests/support/temporary_folder.h"
#include "tools/import/mesh/limited_child.h"
#include "tools/import/mesh/merge.h"
#include "tools/import/mesh/mesh_paths.h"
#include "tools/import/mesh/mesh_reader.h"
#include "tools/import/mesh/primitives.h"
#include "tools/import/mesh/surfaces.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

class MeshFiles : public testing::Test {
 protected:
  MeshFiles() { fs::create_directories(folder_ / "package/meshes"); }

  fs::path write(const fs::path& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  static double volume_m3(const view::Mesh& mesh) {
    double volume = 0.0;
    for (const auto& triangle : mesh.triangles)
      volume +=
          mesh.vertices_m[triangle[0]].cast<double>().dot(mesh.vertices_m[triangle[1]].cast<double>().cross(
              mesh.vertices_m[triangle[2]].cast<double>())) /
          6.0;
    return volume;
  }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path;
};

TEST_F(MeshFiles, PrimitivesFaceOutwards) {
  EXPECT_NEAR(volume_m3(*primitive_surface(ShapeKind::kBox, {0.1, 0.2, 0.3})), 0.006, 1e-8);
  EXPECT_NEAR(volume_m3(*primitive_surface(ShapeKind::kCylinder, {0.1, 0.1, 0.2})), 0.00628, 0.0001);
  EXPECT_NEAR(volume_m3(*primitive_surface(ShapeKind::kSphere, {0.1, 0.1, 0.1})), 0.00419, 0.0003);
  EXPECT_NEAR(volume_m3(*primitive_surface(ShapeKind::kCapsule, {0.1, 0.1, 0.2})), 0.01047, 0.0004);
}

TEST_F(MeshFiles, AreFoundInPackages) {
  write("package/meshes/a.stl", "x");
  write("package/robot.urdf", "x");
  EXPECT_EQ(MeshPaths(folder_ / "package/robot.urdf", {}).find("meshes/a.stl"),
            folder_ / "package/meshes/a.stl");
  EXPECT_FALSE(MeshPaths(folder_ / "package/robot.urdf", {}).find("package://package/meshes/a.stl").empty());
  EXPECT_FALSE(
      MeshPaths(folder_ / "package/robot.urdf", {}).find("package://another_name/meshes/a.stl").empty());
  EXPECT_FALSE(MeshPaths("/nowhere/robot.urdf", {folder_}).find("model://package/meshes/a.stl").empty());
  EXPECT_TRUE(MeshPaths("/nowhere/robot.urdf", {}).find("model://package/meshes/a.stl").empty());
}

// Paths of another machine, of Windows, or with capitals of another file system.
TEST_F(MeshFiles, AreFoundByTheEndOfTheirPaths) {
  write("package/meshes/Leg.STL", "x");
  write("package/robot.urdf", "x");
  const MeshPaths paths(folder_ / "package/robot.urdf", {});
  for (const char* uri :
       {"meshes\\Leg.STL", "C:\\Users\\bob\\kit\\meshes\\Leg.STL", "/home/bob/kit/meshes/Leg.STL",
        "file:///home/bob/kit/meshes/Leg.STL", "package://kit/meshes/leg.stl"}) {
    EXPECT_TRUE(paths.find(uri).empty()) << uri;
    EXPECT_EQ(paths.find_by_end(uri), folder_ / "package/meshes/Leg.STL") << uri;
  }
  EXPECT_TRUE(paths.find_by_end("meshes/arm.stl").empty());
  EXPECT_TRUE(paths.find_by_end("").empty());
}

TEST_F(MeshFiles, StlIsReadBack) {
  const view::Mesh box = *primitive_surface(ShapeKind::kBox, {0.1, 0.2, 0.3});
  const MeshFile read = read_mesh_file(write("box.STL", stl_bytes(box)));
  ASSERT_TRUE(read.mesh) << read.fault;
  EXPECT_EQ(read.mesh->triangles.size(), 12U);
  EXPECT_NEAR(volume_m3(*read.mesh), 0.006, 1e-8);
}

TEST_F(MeshFiles, ObjIsReadByAssimp) {
  const MeshFile read =
      read_mesh_file(write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 4 2\n"));
  ASSERT_TRUE(read.mesh) << read.fault;
  EXPECT_EQ(read.mesh->triangles.size(), 2U);
}

// A triangle in the plane x, y of a file in centimetres with y up stands upright, in metres.
TEST_F(MeshFiles, ColladaHasItsUnitAndItsUpwardAxis) {
  const auto collada = [](const std::string& up) {
    return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>)" +
           up + R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 10 0 0 0 20 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  };
  for (const std::string up : {"Y_UP", "Z_UP"}) {
    const MeshFile read = read_mesh_file(write(up + ".dae", collada(up)));
    ASSERT_TRUE(read.mesh) << read.fault;
    Eigen::AlignedBox3f extent;
    for (const Eigen::Vector3f& vertex : read.mesh->vertices_m) extent.extend(vertex);
    const Eigen::Vector3f expected =
        up == "Y_UP" ? Eigen::Vector3f(0.1F, 0.0F, 0.2F) : Eigen::Vector3f(0.1F, 0.2F, 0.0F);
    EXPECT_LT((extent.sizes() - expected).norm(), 1e-6F) << up << ": " << extent.sizes().transpose();
  }
}

TEST_F(MeshFiles, DamagedOnesAreFaults) {
  EXPECT_FALSE(read_mesh_file(write("cut.stl", std::string(200, 'x'))).mesh);
  EXPECT_FALSE(read_mesh_file(write("cut.dae", "<COLLADA")).mesh);
  EXPECT_FALSE(read_mesh_file(write("cut.obj", "f 1 2 99999999\n")).mesh);
  EXPECT_EQ(read_mesh_file(write("a.glb", "x")).fault, "a mesh of another format, expected STL, DAE or OBJ");
}

TEST_F(MeshFiles, InMillimetresAreRecognised) {
  write("package/meshes/a.stl", stl_bytes(*primitive_surface(ShapeKind::kBox, {100, 200, 300})));
  ImportedRobot robot;
  robot.links.push_back({.name = "a"});
  robot.links[0].visuals.push_back({.kind = ShapeKind::kMesh, .uri = "meshes/a.stl"});
  robot.links[0].visuals.push_back({.kind = ShapeKind::kMesh, .uri = "meshes/b.stl"});
  ImportReport report;
  load_surfaces(robot, MeshPaths(folder_ / "package/robot.urdf", {}), report);
  ASSERT_EQ(robot.links[0].visuals.size(), 1U);
  EXPECT_NEAR(volume_m3(*robot.links[0].visuals[0].surface), 0.006, 1e-7);
  EXPECT_EQ(report.warnings.size(), 1U);
}

TEST_F(MeshFiles, AreSimplified) {
  view::Mesh grid;
  constexpr std::uint32_t kSide = 60;
  for (std::uint32_t i = 0; i < kSide; ++i)
    for (std::uint32_t k = 0; k < kSide; ++k)
      grid.vertices_m.emplace_back(static_cast<float>(i), static_cast<float>(k), 0.0F);
  for (std::uint32_t i = 0; i + 1 < kSide; ++i)
    for (std::uint32_t k = 0; k + 1 < kSide; ++k) {
      const std::uint32_t at = i * kSide + k;
      grid.triangles.push_back({at, at + kSide, at + 1});
      grid.triangles.push_back({at + 1, at + kSide, at + kSide + 1});
    }
  const view::Mesh simple = simplified(grid, 500);
  EXPECT_LE(simple.triangles.size(), 500U);
  EXPECT_GE(simple.triangles.size(), 2U);
}

TEST(LimitedChild, SurvivesWhatItRuns) {
  const ChildLimits limits{.processor_s = 1, .memory_bytes = std::size_t{1} << 30};
  EXPECT_EQ(run_in_child(limits, [] { return std::string(1 << 20, 'a'); }).output.size(), 1U << 20);
  EXPECT_EQ(run_in_child(limits,
                         []() -> std::string {
                           std::raise(SIGKILL);
                           return {};
                         })
                .fault,
            "took more than 1 s");
  EXPECT_EQ(run_in_child(limits, []() -> std::string { throw 1; }).fault, "failed");
  EXPECT_EQ(run_in_child(limits,
                         []() -> std::string {
                           volatile bool forever = true;
                           while (forever) {
                           }
                           return {};
                         })
                .fault,
            "took more than 1 s");
}

// The limit of a child that waits was four times that of its processor time. A machine with much other load
// then left out meshes that an idle one reads, and two imports of the same file differed.
TEST(LimitedChild, HasTimeOnALoadedMachine) {
  ChildLimits limits{.processor_s = 1, .waiting_s = 1};
  const auto sleep = [] {
    std::this_thread::sleep_for(std::chrono::milliseconds(1200));
    return std::string("read");
  };
  EXPECT_EQ(run_in_child(limits, sleep).fault, "waited for more than 1 s");
  limits.waiting_s = ChildLimits{}.waiting_s;
  EXPECT_EQ(run_in_child(limits, sleep).output, "read");
  EXPECT_GE(ChildLimits{}.waiting_s, 30 * ChildLimits{}.processor_s);
}

}  // namespace
}  // namespace koboshi::tools
