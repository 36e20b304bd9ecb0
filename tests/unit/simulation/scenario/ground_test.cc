#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "base/text/user_units.h"
#include "simulation/scenario/make_ground.h"
#include "simulation/scenario/player.h"
#include "simulation/scenario/reader.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/simulation/scenario/temporary_tree.h"

namespace koboshi::simulation {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

// The ground's part of a scenario, from line 4 on.
std::string with(const std::string& ground) {
  return "version: 1\nrobot: robots/box/robot.sdf\nduration_s: 1\n" + ground;
}

Scenario read_on(const TemporaryTree& tree, const std::string& ground) {
  return read_scenario(tree.write("scenarios/test.yaml", with(ground)));
}

sim_board::GroundDescription make(const TemporaryTree& tree, const std::string& ground) {
  const Scenario scenario = read_on(tree, ground);
  return make_ground(scenario.ground, scenario.seed);
}

std::string refusal_of_ground(const TemporaryTree& tree, const std::string& ground) {
  try {
    read_on(tree, ground);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ScenarioGround, IsAHardFloorByDefault) {
  const TemporaryTree tree;
  const sim_board::GroundDescription ground = make(tree, "");
  EXPECT_TRUE(ground.present && ground.is_only_a_plane() && ground.patches.empty());
  EXPECT_EQ(ground.normal_W, Vector3d::UnitZ());
  EXPECT_EQ(ground.surface.friction, sim_board::SurfaceDescription{}.friction);
  EXPECT_EQ(ground.surface.constraint_force_mixing, sim_board::SurfaceDescription{}.constraint_force_mixing);
}

TEST(ScenarioGround, ReadsASurface) {
  const TemporaryTree tree;
  const sim_board::GroundDescription ground =
      make(tree,
           "ground: {material: ice, friction: [0.1, 0.2], friction_direction_deg: 90, bounce: 0.3,\n"
           "         bounce_threshold_m_per_s: 0.05, slip_m_per_N_s: 0.004,\n"
           "         stiffness_N_per_m: 2000, damping_N_s_per_m: 20}\n");
  EXPECT_EQ(ground.surface.material, "ice");
  EXPECT_EQ(ground.surface.friction, 0.1);
  EXPECT_EQ(ground.surface.friction_second, 0.2);
  EXPECT_LT((*ground.surface.friction_direction - Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_EQ(ground.surface.bounce, 0.3);
  EXPECT_EQ(ground.surface.bounce_threshold_m_per_s, 0.05);
  EXPECT_EQ(ground.surface.slip_m_per_N_s, 0.004);
  EXPECT_NEAR(ground.surface.constraint_force_mixing, 1.0 / (0.001 * 2000 + 20), 1e-12);
}

TEST(ScenarioGround, ReadsEveryShapeAndRotatesItWithThePlane) {
  const TemporaryTree tree;
  tree.write("scenarios/bump.csv", "0, 0, 0\n0, 0.02, 0\n0, 0, 0.01\n");
  tree.write("scenarios/bump.pgm", "P2\n# a comment\n3 2\n255\n0 0 255\n0 51 0\n");
  const std::string shapes =
      "  shapes:\n"
      "    - box: {position_m: [1, 0], size_m: [0.2, 0.3, 0.04], bottom_m: 0.01, yaw_deg: 90}\n"
      "    - ramp: {position_m: [2, 0], length_m: 1, width_m: 0.5, angle_deg: 10, friction: 0.9}\n"
      "    - steps: {position_m: [0, 2], yaw_deg: 90, count: 3, rise_m: 0.02, run_m: 0.1, width_m: 0.4}\n"
      "    - patch: {position_m: [0.5, 0], radius_m: 0.2, friction: 0.1, material: ice}\n"
      "    - patch: {position_m: [0.5, 1], size_m: [0.2, 0.4], friction: 0.2}\n"
      "    - height_field: {file: bump.csv, position_m: [-1, 0], size_m: [0.4, 0.2]}\n"
      "    - height_field: {file: bump.pgm, position_m: [-2, 0], size_m: [0.4, 0.2], height_m: 0.05}\n";
  const sim_board::GroundDescription ground = make(tree, "ground:\n  friction: 0.6\n" + shapes);
  ASSERT_EQ(ground.boxes.size(), 5u);
  EXPECT_NEAR(height_above(ground, {1.14, 0.09, 0.5}), 0.5 - 0.05, 1e-12);
  EXPECT_NEAR(height_above(ground, {0.0, 2.25, 0.5}), 0.5 - 0.06, 1e-12);
  EXPECT_EQ(ground.boxes[0].surface.friction, 0.6);  // as the plane
  EXPECT_EQ(ground.boxes[1].surface.friction, 0.9);
  ASSERT_EQ(ground.patches.size(), 2u);
  EXPECT_EQ(ground.patches[0].outline, sim_board::FrictionPatch::Outline::kDisc);
  EXPECT_EQ(ground.patches[0].surface.material, "ice");
  EXPECT_TRUE(ground.patches[0].holds({0.5, 0.19, 0.0}));
  EXPECT_FALSE(ground.patches[0].holds({0.5, 0.21, 0.0}));
  ASSERT_EQ(ground.height_fields.size(), 2u);
  EXPECT_NEAR(ground.height_fields[0].point_F(1, 1).z(), 0.02, 1e-12);
  EXPECT_LT((ground.height_fields[0].X_WF.translation() - Vector3d(-1.0, 0.0, 0.0)).norm(), 1e-12);
  // The last line is the row of the lowest y.
  EXPECT_NEAR(ground.height_fields[0].point_F(2, 0).z(), 0.01, 1e-12);
  EXPECT_NEAR(ground.height_fields[1].point_F(2, 1).z(), 0.05, 1e-12);
  EXPECT_NEAR(ground.height_fields[1].point_F(1, 0).z(), 0.01, 1e-12);

  const sim_board::GroundDescription tilted = make(tree, "ground:\n  tilt_deg: [5, -3]\n" + shapes);
  const Eigen::Isometry3d X_WG(Eigen::AngleAxisd(-3 * kRadPerDegree, Vector3d::UnitY()) *
                               Eigen::AngleAxisd(5 * kRadPerDegree, Vector3d::UnitX()));
  EXPECT_TRUE(tilted.boxes[3].X_WG.isApprox(X_WG * ground.boxes[3].X_WG, 1e-12));
  EXPECT_TRUE(tilted.patches[1].X_WP.isApprox(X_WG * ground.patches[1].X_WP, 1e-12));
  EXPECT_TRUE(tilted.height_fields[1].X_WF.isApprox(X_WG * ground.height_fields[1].X_WF, 1e-12));
}

TEST(ScenarioGround, MakesRoughGroundFromItsSeed) {
  const TemporaryTree tree;
  const auto rough = [&](const std::string& more) {
    return make(tree,
                "ground: {shapes: [{height_field: {position_m: [0, 0], size_m: [0.6, 0.4], height_m: 0.01,\n"
                "         wavelength_m: 0.08" +
                    more + "\n")
        .height_fields.at(0);
  };
  const sim_board::HeightField field = rough(", spacing_m: 0.01}}]}");
  EXPECT_EQ(field.columns, 61);
  EXPECT_EQ(field.rows, 41);
  const auto [lowest, highest] = std::ranges::minmax(field.heights_m);
  EXPECT_EQ(lowest, 0.0);
  EXPECT_GT(highest, 0.007);
  EXPECT_LE(highest, 0.01);
  for (int column = 0; column < field.columns; ++column) EXPECT_EQ(field.point_F(column, 0).z(), 0.0);
  EXPECT_EQ(field.heights_m, rough(", spacing_m: 0.01}}]}").heights_m);
  EXPECT_EQ(field.heights_m, rough(", spacing_m: 0.01, seed: 1}}]}").heights_m);  // the scenario's
  EXPECT_NE(field.heights_m, rough(", spacing_m: 0.01, seed: 2}}]}").heights_m);
  EXPECT_NE(field.heights_m, rough(", spacing_m: 0.01}}]}\nseed: 2").heights_m);
}

TEST(ScenarioGround, NamesFieldValueAndRange) {
  const TemporaryTree tree;
  tree.write("scenarios/ragged.csv", "0, 0\n0, 0, 0\n");
  tree.write("scenarios/word.csv", "0, 0\n0, high\n");
  tree.write("scenarios/bright.pgm", "P2\n2 2\n255\n0 256\n0 0\n");
  tree.write("scenarios/short.pgm", "P2\n2 2\n255\n0 1\n0\n");
  const auto shape = [](const std::string& text) { return "ground:\n  shapes:\n    - " + text + "\n"; };
  struct Case {
    std::string ground;
    std::vector<std::string> said;
  };
  const std::string field = "height_field: {position_m: [0, 0], size_m: [1, 1], ";
  for (const Case& bad : std::vector<Case>{
           {"ground: {friction: -0.1}", {"test.yaml:4: ", "ground.friction", "-0.1", "from 0 to 10"}},
           {"ground: {friction: [0.1, 11]}", {"test.yaml:4: ", "friction", "11", "from 0 to 10"}},
           {"ground: {bounce: 1.5}", {"test.yaml:4: ", "ground.bounce", "1.5", "from 0 to 1"}},
           {"ground: {stiffness_N_per_m: 500}", {"test.yaml:4: ", "damping_N_s_per_m", "from 0 to"}},
           {"ground: {slip_m_per_N_s: -1}", {"slip_m_per_N_s", "-1", "from 0 to 10"}},
           {shape("cone: {}"), {"test.yaml:6: ", "box, ramp, steps, patch or height_field"}},
           {shape("{patch: {}, box: {}}"), {"test.yaml:6: ", "2 kinds"}},
           {shape("box: {position_m: [0, 0], size_m: [1, 1, 0]}"),
            {":6: ", "size_m", "0", "from 0.001 to 100"}},
           {shape("box: {position_m: [0, 0], size_m: [1, 1, 1], colour: red}"), {":6: ", "colour"}},
           {shape("ramp: {position_m: [0, 0], length_m: 1, width_m: 1, angle_deg: 50}"),
            {":6: ", "angle_deg", "50", "from 0.1 to 45"}},
           {shape("steps: {position_m: [0, 0], count: 0, rise_m: 0.1, run_m: 1, width_m: 1}"),
            {":6: ", "count", "0", "from 1 to 200"}},
           {shape("patch: {position_m: [0, 0], size_m: [1, 1], radius_m: 1}"), {":6: ", "one of the two"}},
           {shape("patch: {position_m: [0, 0]}"), {":6: ", "size_m"}},
           {shape(field + "file: none.csv}"), {":6: ", "none.csv"}},
           {shape(field + "file: word.csv}"), {"word.csv:2: ", "high", "from -10 to 10"}},
           {shape(field + "file: ragged.csv}"), {"ragged.csv:2: ", "3 heights", "2 as in the first line"}},
           {shape(field + "file: bright.pgm, height_m: 1}"), {"bright.pgm:4: ", "256", "from 0 to 255"}},
           {shape(field + "file: short.pgm, height_m: 1}"), {"short.pgm:5: ", "the end of the image"}},
           {shape(field + "file: short.pgm}"), {"short.pgm"}},
           {shape(field + "height_m: 0.01}"), {":6: ", "file and wavelength_m"}},
           {"materials: [{between: [ice]}]", {"test.yaml:4: ", "1 materials", "a list of two"}},
           {"materials: [{between: [ice, tin], bounce: 2}]", {"bounce", "2", "from 0 to 1"}},
           {"materials: [{between: [ice, tin]}, {between: [tin, ice]}]", {"each pair once"}},
       }) {
    const std::string said = refusal_of_ground(tree, bad.ground);
    for (const std::string& part : bad.said) EXPECT_THAT(said, HasSubstr(part)) << bad.ground;
  }
}

TEST(ScenarioMaterials, AreReadAsPairs) {
  const TemporaryTree tree;
  const Scenario scenario = read_on(
      tree,
      "materials:\n"
      "  - {between: [rubber, ice], friction: [0.1, 0.05], bounce: 0.2, bounce_threshold_m_per_s: 0.1,\n"
      "     stiffness_N_per_m: 5000, damping_N_s_per_m: 50, slip_m_per_N_s: 0.01}\n"
      "  - {between: [rubber, rubber], friction: 1.2}\n");
  ASSERT_EQ(scenario.materials.size(), 2u);
  const sim_board::MaterialPair& ice = scenario.materials[0].pair;
  EXPECT_EQ(ice.between, (std::array<std::string, 2>{"rubber", "ice"}));
  EXPECT_EQ(ice.friction, (std::array{0.1, 0.05}));
  EXPECT_EQ(ice.bounce, 0.2);
  EXPECT_EQ(ice.bounce_threshold_m_per_s, 0.1);
  EXPECT_EQ(ice.spring->stiffness_N_per_m, 5000.0);
  EXPECT_EQ(ice.spring->damping_N_s_per_m, 50.0);
  EXPECT_EQ(ice.slip_m_per_N_s, 0.01);
  EXPECT_EQ(scenario.materials[1].pair.friction, (std::array{1.2, 1.2}));
  EXPECT_FALSE(scenario.materials[1].pair.bounce || scenario.materials[1].pair.spring);
}

TEST(ScenarioMaterials, MustExistInRobotOrGround) {
  const TemporaryTree tree;
  sim_board::RobotDescription robot = sim_board::sample_box(1.0, {0.1, 0.1, 0.1});
  robot.links[0].collisions[0].surface.material = "rubber";
  const Scenario scenario =
      read_on(tree, "ground: {material: steel}\nmaterials: [{between: [rubber, stele]}]\n");
  try {
    check(scenario, robot);
    FAIL() << "a material that nothing is of";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("test.yaml:5: found the unknown material stele, expected rubber or steel"));
  }
  const Scenario right =
      read_on(tree, "ground: {material: steel}\nmaterials: [{between: [rubber, steel]}]\n");
  EXPECT_NO_THROW(check(right, robot));
}

// Bodies lie on what is below them, also on a slope, and are where their height says.
TEST(ScenarioBodies, AreReadAndLaidOnTheGround) {
  const TemporaryTree tree;
  const std::string bodies =
      "bodies:\n"
      "  - {name: ball, diameter_m: 0.065, mass_kg: 0.058, position_m: [0.3, -0.1], bounce: 0.7, friction: "
      "0.4,\n"
      "     rolling_friction: 0.03, contact_time_ms: 4, velocity_m_per_s: [1, 2, 3]}\n"
      "  - {name: crate, size_m: [0.2, 0.1, 0.05], mass_kg: 0.3, position_m: [1, 0], yaw_deg: 90}\n"
      "  - {name: kite, diameter_m: 0.1, mass_kg: 0.1, position_m: [0, 0], height_m: 1.5}\n";
  const auto laid = [&](const std::string& ground) {
    const Scenario scenario = read_on(tree, ground + bodies);
    return board_options(scenario, sim_board::sample_box(1.0, Vector3d::Constant(0.1))).world.free_bodies;
  };
  const std::vector<sim_board::FreeBodyDescription> level = laid("");
  ASSERT_EQ(level.size(), 3u);
  EXPECT_EQ(level[0].shape, sim_board::FreeBodyDescription::Shape::kSphere);
  EXPECT_LT((level[0].X_WF.translation() - Vector3d(0.3, -0.1, 0.0325)).norm(), 1e-9);
  EXPECT_EQ(level[0].bounce, 0.7);
  EXPECT_EQ(level[0].friction, 0.4);
  EXPECT_EQ(level[0].rolling_friction, 0.03);
  EXPECT_DOUBLE_EQ(level[0].contact_time_s, 0.004);
  EXPECT_EQ(level[0].v_WF_W, Vector3d(1, 2, 3));
  EXPECT_EQ(level[1].shape, sim_board::FreeBodyDescription::Shape::kBox);
  EXPECT_LT((level[1].X_WF.linear().col(0) - Vector3d::UnitY()).norm(), 1e-9);
  EXPECT_NEAR(level[1].X_WF.translation().z(), 0.025, 1e-9);
  EXPECT_EQ(level[2].X_WF.translation().z(), 1.5);
  const auto tilted = laid("ground: {tilt_deg: [0, 10]}\n");
  const double away_m = std::sin(10 * kRadPerDegree) * tilted[0].X_WF.translation().x() +
                        std::cos(10 * kRadPerDegree) * tilted[0].X_WF.translation().z();
  EXPECT_NEAR(away_m, 0.0325, 1e-6);
  const auto stepped = laid("ground: {shapes: [{box: {position_m: [1, 0], size_m: [0.5, 0.5, 0.2]}}]}\n");
  EXPECT_NEAR(stepped[1].X_WF.translation().z(), 0.225, 1e-6);
}

TEST(ScenarioBodies, ThatAreWrongAreRefusedWithTheLine) {
  const TemporaryTree tree;
  const auto refusal = [&](const std::string& body) {
    return refusal_of_ground(tree,
                             "bodies:\n  - {name: ball, mass_kg: 0.1, position_m: [0, 0], " + body + "}\n");
  };
  EXPECT_THAT(refusal("diameter_m: 0.1, size_m: [1, 1, 1]"), HasSubstr("test.yaml:5: found size_m beside"));
  EXPECT_THAT(refusal("bounce: 0.2"), HasSubstr("no key bodies[0].diameter_m"));
  EXPECT_THAT(refusal("diameter_m: 0"), HasSubstr("test.yaml:5: found bodies[0].diameter_m = 0"));
  EXPECT_THAT(refusal("diameter_m: 0.1, bounce: 2"), HasSubstr("test.yaml:5: found bodies[0].bounce = 2"));
  EXPECT_THAT(refusal("diameter_m: 0.1, colour: red"), HasSubstr("colour"));
  EXPECT_THAT(refusal("size_m: [1, 1, 1], rolling_friction: 0.1"), HasSubstr("rolling_friction"));
  EXPECT_THAT(refusal_of_ground(tree,
                                "bodies:\n  - {name: a, diameter_m: 1, mass_kg: 1, position_m: [0, 0]}\n"
                                "  - {name: a, diameter_m: 1, mass_kg: 1, position_m: [0, 0]}\n"),
              HasSubstr("test.yaml:6: found a second body a"));
}

}  // namespace
}  // namespace koboshi::simulation
