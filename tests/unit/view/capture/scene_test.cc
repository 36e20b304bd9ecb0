#include "view/capture/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>

#include "sim_board/description/load.h"
#include "tests/support/temporary_folder.h"
#include "view/capture/stl.h"

namespace koboshi::view {
namespace {

using Corner = std::array<float, 3>;

// A binary STL file of these triangles.
std::string stl_of(const std::vector<std::array<Corner, 3>>& triangles) {
  std::string bytes(80, ' ');
  const auto count = static_cast<std::uint32_t>(triangles.size());
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  for (const auto& corners : triangles) {
    bytes.append(12, '\0');
    bytes.append(reinterpret_cast<const char*>(&corners), sizeof corners);
    bytes.append(2, '\0');
  }
  return bytes;
}

const std::vector<std::array<Corner, 3>> kSquare{{{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}}},
                                                 {{{0, 0, 0}, {2, 2, 0}, {0, 2, 0}}}};

TEST(Stl, SharesVertices) {
  const test::TemporaryFolder folder;
  test::write_file(folder.path / "square.stl", stl_of(kSquare));
  const auto mesh = read_stl(folder.path / "square.stl").mesh;
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->vertices_m.size(), 4u);
  ASSERT_EQ(mesh->triangles.size(), 2u);
  EXPECT_EQ(mesh->vertices_m[mesh->triangles[1][2]], Eigen::Vector3f(0, 2, 0));
}

TEST(Stl, IsNothingInAnotherFormat) {
  const test::TemporaryFolder folder;
  const std::string stl = stl_of(kSquare);
  for (const std::string& other :
       {std::string("solid square\nendsolid\n"), stl.substr(0, stl.size() - 1), stl + "x", std::string()}) {
    test::write_file(folder.path / "other.stl", other);
    const StlFile file = read_stl(folder.path / "other.stl");
    EXPECT_FALSE(file.mesh);
    EXPECT_NE(file.fault, "");
  }
  EXPECT_FALSE(read_stl(folder.path / "none.stl").mesh);
}

std::string ascii_of(const std::vector<std::array<Corner, 3>>& triangles) {
  std::ostringstream text;
  text << "solid a name with blanks\r\n";
  for (const auto& corners : triangles) {
    text << "  FACET NORMAL 0 0 1\n    outer loop\n";
    for (const Corner& corner : corners)
      text << "\tvertex " << corner[0] << " +" << corner[1] << " " << corner[2] << "e0\n";
    text << "    endloop\n  endfacet\n";
  }
  text << "endsolid a name with blanks\n";
  return text.str();
}

TEST(Stl, ReadsAsciiAsItReadsBinary) {
  const test::TemporaryFolder folder;
  test::write_file(folder.path / "binary.stl", stl_of(kSquare));
  test::write_file(folder.path / "ascii.stl", ascii_of(kSquare));
  const StlFile binary = read_stl(folder.path / "binary.stl");
  const StlFile ascii = read_stl(folder.path / "ascii.stl");
  ASSERT_TRUE(binary.mesh);
  ASSERT_TRUE(ascii.mesh) << ascii.fault;
  EXPECT_EQ(ascii.mesh->vertices_m, binary.mesh->vertices_m);
  EXPECT_EQ(ascii.mesh->triangles, binary.mesh->triangles);
}

TEST(Stl, RefusesDamagedFiles) {
  const test::TemporaryFolder folder;
  const auto fault_of = [&](const std::string& content) {
    test::write_file(folder.path / "damaged.stl", content);
    const StlFile file = read_stl(folder.path / "damaged.stl");
    EXPECT_FALSE(file.mesh);
    EXPECT_TRUE(file.is_damaged);
    return file.fault;
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float value : {kNan, kInfinity, -kInfinity})
    EXPECT_EQ(fault_of(stl_of({{{{0, 0, 0}, {2, value, 0}, {2, 2, 0}}}})),
              "a vertex that is no finite number");
  const std::string good = ascii_of(kSquare);
  for (const std::string number : {"nan", "inf", "1e99", "-1e999"})
    EXPECT_EQ(fault_of(std::string(good).replace(good.find("+2"), 2, number)),
              "a vertex that is no finite number");
  EXPECT_EQ(fault_of(std::string(good).replace(good.find("+2"), 2, "two")),
            "in line 6 'two' instead of a number");
  EXPECT_EQ(fault_of(good.substr(0, good.find("endloop"))), "in line 7 the end instead of endloop");
  EXPECT_EQ(fault_of("solid empty\nendsolid\n"), "no triangle");
}

const sim_board::RobotDescription& default_robot() {
  static const sim_board::RobotDescription robot =
      sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  return robot;
}

TEST(Scene, SaysWhichMeshItCannotShow) {
  const test::TemporaryFolder folder;
  test::write_file(folder.path / "helmet.stl", "no mesh");
  sim_board::RobotDescription robot = default_robot();
  EXPECT_TRUE(make_scene(robot, {}).mesh_faults.empty());
  robot.links[1].meshes.front().file = folder.path / "helmet.stl";
  const Scene scene = make_scene(robot, {});
  ASSERT_EQ(scene.mesh_faults.size(), 1u);
  EXPECT_THAT(scene.mesh_faults.front(),
              testing::StartsWith("The mesh helmet.stl of " + robot.links[1].name + " cannot be shown: "));
}

TEST(Scene, HoldsEveryLinkWithItsShapes) {
  const Scene scene = make_scene(default_robot(), {});
  ASSERT_EQ(scene.links.size(), default_robot().links.size());
  std::size_t meshes = 0;
  std::size_t described = 0;
  double mass_kg = 0.0;
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    const Link& link = scene.links[i];
    EXPECT_EQ(link.name, default_robot().links[i].name);
    EXPECT_EQ(link.collisions.size(), default_robot().links[i].collisions.size());
    EXPECT_EQ(link.parent == -1, i == 0) << link.name;
    mass_kg += link.mass_kg;
    described += default_robot().links[i].meshes.size();
    for (const Shape& shape : link.visuals) meshes += shape.geometry.index();
  }
  EXPECT_NEAR(mass_kg, default_robot().total_mass_kg(), 1e-9);
  EXPECT_EQ(meshes, described);
  EXPECT_GT(meshes, 10u);
}

// Meshes are scaled to metres: the trunk's are about as high as its collision box.
TEST(Scene, ScalesMeshes) {
  const Scene scene = make_scene(default_robot(), {});
  const Link& trunk = scene.links[0];
  Eigen::AlignedBox3d box;
  for (const Shape& shape : trunk.visuals) {
    if (const auto* mesh = std::get_if<Mesh>(&shape.geometry))
      for (const Eigen::Vector3f& vertex : mesh->vertices_m) box.extend(shape.X_LG * vertex.cast<double>());
  }
  const double height_m = std::get<Box>(trunk.collisions[0].geometry).size_m.z();
  EXPECT_GT(box.sizes().z(), 0.5 * height_m);
  EXPECT_LT(box.sizes().z(), 2.0 * height_m);
}

TEST(Scene, ShowsCollisionBoxesForAMeshThatCannotBeRead) {
  sim_board::RobotDescription robot = default_robot();
  robot.links[0].meshes[0].file = "no_such.stl";
  const Scene scene = make_scene(robot, {});
  const auto boxes = [](const std::vector<Shape>& shapes) {
    return std::ranges::count_if(
        shapes, [](const Shape& shape) { return std::holds_alternative<Box>(shape.geometry); });
  };
  EXPECT_EQ(boxes(scene.links[0].visuals), std::ssize(robot.links[0].visual_boxes) + 1);
  EXPECT_EQ(scene.links[0].visuals.size(), make_scene(default_robot(), {}).links[0].visuals.size());
}

// The outline of each sole turns counter-clockwise as seen from above.
TEST(Scene, KnowsTheSoles) {
  const Scene scene = make_scene(default_robot(), {});
  for (std::size_t side = 0; side < 2; ++side) {
    ASSERT_GE(scene.sole_links[side], 0);
    const auto& corners = scene.soles_L[side];
    ASSERT_EQ(corners.size(), 4u);
    const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[1]);
    EXPECT_GT(normal.z(), 0.001);
  }
  EXPECT_NE(scene.sole_links[0], scene.sole_links[1]);
}

TEST(Scene, HoldsTheGround) {
  sim_board::GroundDescription ground;
  ground.normal_W = {0.0, 0.0, 2.0};
  ground.boxes.emplace_back().size_m = {1.0, 2.0, 3.0};
  sim_board::HeightField& field = ground.height_fields.emplace_back();
  field.columns = 3;
  field.rows = 2;
  field.heights_m = {0, 0, 0, 0, 0.1, 0};
  sim_board::FrictionPatch disc;
  disc.outline = sim_board::FrictionPatch::Outline::kDisc;
  ground.patches = {{}, disc};
  const Scene scene = make_scene(default_robot(), ground);
  ASSERT_EQ(scene.planes.size(), 1u);
  EXPECT_EQ(scene.planes[0].normal_W, Eigen::Vector3d::UnitZ());
  ASSERT_EQ(scene.ground.size(), 4u);
  EXPECT_EQ(std::get<Box>(scene.ground[0].geometry).size_m, Eigen::Vector3d(1.0, 2.0, 3.0));
  const Mesh& mesh = std::get<Mesh>(scene.ground[1].geometry);
  EXPECT_EQ(mesh.vertices_m.size(), 6u);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  for (const Shape& shape : {scene.ground[1], scene.ground[3]}) {
    const Mesh& faces = std::get<Mesh>(shape.geometry);
    for (const auto& [a, b, c] : faces.triangles) {
      const auto& v = faces.vertices_m;
      EXPECT_GT((v[b] - v[a]).cross(v[c] - v[a]).z(), 0.0F);
    }
  }
  ground.present = false;
  EXPECT_TRUE(make_scene(default_robot(), ground).planes.empty());
}

// A ball's three zones close to a sphere whose faces look outwards.
TEST(Scene, HoldsLooseBodiesBehindTheLinks) {
  sim_board::FreeBodyDescription ball{.name = "ball"};
  ball.size_m.x() = 0.2;
  sim_board::FreeBodyDescription crate{.name = "crate", .shape = sim_board::FreeBodyDescription::Shape::kBox};
  crate.size_m = Eigen::Vector3d(0.1, 0.2, 0.3);
  const Scene scene = make_scene(default_robot(), {}, {ball, crate});
  const std::size_t links = default_robot().links.size();
  ASSERT_EQ(scene.links.size(), links + 2);
  EXPECT_EQ(scene.links[links].name, "ball");
  EXPECT_EQ(scene.links[links].mass_kg, 0.0) << "it is no part of the robot's centre of mass";
  EXPECT_EQ(std::get<Box>(scene.links[links + 1].visuals.at(0).geometry).size_m, crate.size_m);
  double volume_m3 = 0.0;
  for (const Shape& zone : scene.links[links].visuals) {
    const Mesh& mesh = std::get<Mesh>(zone.geometry);
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto& v = mesh.vertices_m;
      EXPECT_GT((v[b] - v[a]).cross(v[c] - v[a]).dot(v[a] + v[b] + v[c]), 0.0F);
      volume_m3 += static_cast<double>(v[a].dot(v[b].cross(v[c]))) / 6.0;
    }
  }
  const double sphere_m3 = 4.0 / 3.0 * std::numbers::pi * 1e-3;
  EXPECT_NEAR(volume_m3, sphere_m3, 0.03 * sphere_m3);
}

}  // namespace
}  // namespace koboshi::view
