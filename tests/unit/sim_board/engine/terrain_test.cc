#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim_board/engine/make_world.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

constexpr double kMass_kg = 1.2;
const Vector3d kSole_m(0.1, 0.056, 0.01);

// A foot-sized box on some ground.
struct Sole {
  RobotDescription robot = sample_box(kMass_kg, kSole_m);
  WorldOptions options;
  std::unique_ptr<World> world;

  Sole() { options.X_WB.translation().z() = 0.5 * kSole_m.z(); }
  SurfaceDescription& surface() { return robot.links[0].collisions[0].surface; }
  void place(const Isometry3d& X_WB) { options.X_WB = X_WB; }
  void run(double duration_s, const Vector3d& push_N = Vector3d::Zero()) {
    if (!world) world = make_world(robot, options);
    const auto steps = std::lround(duration_s / world->step_s());
    for (long i = 0; i < steps; ++i) {
      if (!push_N.isZero()) world->push(0, {0.0, 0.0, -0.5 * kSole_m.z()}, push_N);
      world->step();
    }
  }
  Vector3d position() const { return world->body(0).X_WL.translation(); }
  Vector3d velocity() const { return world->body(0).v_WCom_W; }
};

void set_friction(SurfaceDescription& surface, double friction, double friction_second) {
  surface.friction = friction;
  surface.friction_second = friction_second;
}

// A sole half way up a ramp with this friction.
Sole on_ramp(double angle_rad, double friction) {
  Sole sole;
  const Ramp ramp{.X_WR = Isometry3d::Identity(), .length_m = 2.0, .width_m = 1.0, .angle_rad = angle_rad};
  sole.options.ground.boxes.push_back(ramp_box(ramp));
  set_friction(sole.options.ground.boxes[0].surface, friction, friction);
  sole.place(Translation3d(1.0, 0.0, std::tan(angle_rad)) * Eigen::AngleAxisd(-angle_rad, Vector3d::UnitY()) *
             Translation3d(0.0, 0.0, 0.5 * kSole_m.z()));
  return sole;
}

TEST(Ramp, HoldsASoleBelowTheFrictionAngle) {
  Sole sole = on_ramp(std::atan(0.45), 0.5);
  sole.run(0.1);
  const Vector3d start = sole.position();
  sole.run(1.0);
  EXPECT_LT((sole.position() - start).norm(), 1e-5);
  EXPECT_NEAR(start.z(), 0.45 + 0.5 * kSole_m.z() * std::cos(std::atan(0.45)), 1e-4);
}

TEST(Ramp, LetsASoleSlideAboveTheFrictionAngle) {
  const double angle_rad = std::atan(0.6);
  Sole sole = on_ramp(angle_rad, 0.5);
  sole.run(0.3);
  const double expected = kGravity * (std::sin(angle_rad) - 0.5 * std::cos(angle_rad)) * 0.3;
  EXPECT_NEAR(sole.velocity().norm(), expected, 0.02 * expected);
  EXPECT_LT(sole.velocity().x(), 0.0);
}

// A push that the first direction's friction would let slide and the second's holds.
TEST(Anisotropy, AllowsSlidingInOneDirectionOnly) {
  const double push_N = 0.4 * kMass_kg * kGravity;
  const auto speed = [&](const Vector3d& direction, std::optional<Vector3d> ground,
                         std::optional<Vector3d> sole_direction, double yaw_rad) {
    Sole sole;
    set_friction(sole.options.ground.surface, 0.2, 0.8);
    set_friction(sole.surface(), 0.8, 0.8);
    if (sole_direction) set_friction(sole.surface(), 0.2, 0.8);
    sole.options.ground.surface.friction_direction = ground;
    sole.surface().friction_direction = sole_direction;
    sole.options.X_WB.linear() = Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
    sole.run(0.3, push_N * direction);
    return sole.velocity().norm();
  };
  const double expected = 0.2 * kGravity * 0.3;  // (0.4 - 0.2) g t
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY();
  EXPECT_NEAR(speed(x, {}, {}, 0.0), expected, 0.02 * expected);
  EXPECT_LT(speed(y, {}, {}, 0.0), 1e-4);
  // Turned with the ground's direction; a box that turns on the ground changes nothing.
  EXPECT_NEAR(speed(y, y, {}, 0.0), expected, 0.02 * expected);
  EXPECT_LT(speed(x, y, {}, 0.0), 1e-4);
  EXPECT_NEAR(speed(x, {}, {}, 0.7), expected, 0.02 * expected);
  // The box's own direction turns with it, like a skate.
  const Vector3d along(std::cos(0.7), std::sin(0.7), 0.0), across(-std::sin(0.7), std::cos(0.7), 0.0);
  EXPECT_NEAR(speed(along, {}, x, 0.7), expected, 0.02 * expected);
  EXPECT_LT(speed(across, {}, x, 0.7), 1e-4);
}

TEST(Patch, ChangesTheDecelerationAtItsEdge) {
  Sole sole;
  set_friction(sole.options.ground.surface, 0.6, 0.6);
  FrictionPatch& patch = sole.options.ground.patches.emplace_back();
  patch.X_WP = Translation3d(1.0, 0.0, 0.0);
  patch.size_m = {1.0, 0.4};
  set_friction(patch.surface, 0.1, 0.1);
  // From before the patch, with a speed that takes it far into it.
  sole.run(0.2);
  sole.run(0.2, {2.0 * kMass_kg * kGravity, 0.0, 0.0});
  const auto deceleration = [&] {
    const double before = sole.velocity().x();
    sole.run(0.01);
    return (before - sole.velocity().x()) / 0.01;
  };
  while (sole.position().x() < 0.3) {
    const double x = sole.position().x();
    const double slowed = deceleration();
    if (x < 0.4) {
      EXPECT_NEAR(slowed, 0.6 * kGravity, 0.05) << x;
    }
  }
  while (sole.position().x() < 0.6) sole.run(0.001);
  const double inside = deceleration();
  ASSERT_LT(sole.position().x(), 1.4);
  EXPECT_NEAR(inside, 0.1 * kGravity, 0.02);
}

TEST(Patch, TheLastPatchThatContainsAPointIsUsed) {
  Sole sole;
  for (const double friction : {0.0, 0.5}) {
    FrictionPatch& patch = sole.options.ground.patches.emplace_back();
    patch.outline = FrictionPatch::Outline::kDisc;
    set_friction(patch.surface, friction, friction);
  }
  sole.run(0.5, {0.4 * kMass_kg * kGravity, 0.0, 0.0});
  EXPECT_LT(sole.velocity().norm(), 1e-4);
}

TEST(MaterialPair, BouncesToTheSquareOfItsRestitution) {
  for (const double restitution : {0.5, 0.8}) {
    Sole sole;
    sole.options.step_s = 0.00025;  // the height of the fall is known to a step's way
    sole.robot = sample_box(1.0, {0.1, 0.1, 0.1});
    sole.surface().material = "rubber";
    sole.options.ground.surface.material = "steel";
    // Hard, for a soft contact takes a share of the rebound (docs/reference/ground.md).
    sole.options.material_pairs.push_back({.between = {"steel", "rubber"},
                                           .friction = {},
                                           .bounce = restitution,
                                           .bounce_threshold_m_per_s = {},
                                           .spring = MaterialPair::Spring{1e7, 1e6},
                                           .slip_m_per_N_s = {}});
    const double drop_m = 0.2;
    sole.options.X_WB.translation().z() = 0.05 + drop_m;
    sole.run(std::sqrt(2 * drop_m / kGravity) + 0.01);
    ASSERT_GT(sole.velocity().z(), 0.0);
    double highest_m = 0.0;
    while (sole.velocity().z() > 0.0) {
      sole.run(0.00025);
      highest_m = std::max(highest_m, sole.position().z() - 0.05);
    }
    EXPECT_NEAR(highest_m, restitution * restitution * drop_m, 0.02 * restitution * restitution * drop_m);
  }
}

TEST(MaterialPair, SinksByItsStiffnessAtAnyStep) {
  for (const double step_s : {0.001, 0.00025}) {
    Sole sole;
    sole.options.step_s = step_s;
    sole.surface().material = sole.options.ground.surface.material = "foam";
    sole.options.material_pairs.push_back({.between = {"foam", "foam"},
                                           .friction = {},
                                           .bounce = {},
                                           .bounce_threshold_m_per_s = {},
                                           .spring = MaterialPair::Spring{5000.0, 50.0},
                                           .slip_m_per_N_s = {}});
    sole.run(2.0);
    EXPECT_NEAR(0.5 * kSole_m.z() - sole.position().z(), kMass_kg * kGravity / (4 * 5000.0), 1e-7) << step_s;
  }
}

// Four points share the force, so each slides by a quarter of it; the force does not reach mu N.
TEST(MaterialPair, SlipsByItsForceAtAnyStep) {
  for (const double step_s : {0.001, 0.00025}) {
    Sole sole;
    sole.options.step_s = step_s;
    sole.surface().material = "felt";
    sole.options.ground.surface.material = "oil";
    sole.options.material_pairs.push_back({.between = {"felt", "oil"},
                                           .friction = std::array{0.9, 0.9},
                                           .bounce = {},
                                           .bounce_threshold_m_per_s = {},
                                           .spring = {},
                                           .slip_m_per_N_s = 0.02});
    sole.run(1.0, {4.0, 0.0, 0.0});
    EXPECT_NEAR(sole.velocity().x(), 0.02 * 4.0 / 4, 1e-5) << step_s;
    EXPECT_NEAR(sole.velocity().y(), 0.0, 1e-6);
  }
}

TEST(MaterialPair, DoesNotAffectOtherMaterials) {
  Sole sole;
  sole.surface().material = "rubber";
  sole.options.material_pairs.push_back({.between = {"rubber", "ice"},
                                         .friction = std::array{0.0, 0.0},
                                         .bounce = {},
                                         .bounce_threshold_m_per_s = {},
                                         .spring = {},
                                         .slip_m_per_N_s = {}});
  sole.run(0.5, {0.5 * kMass_kg * kGravity, 0.0, 0.0});
  EXPECT_LT(sole.velocity().norm(), 1e-4);
}

TEST(GroundBox, CarriesASoleOnItsTop) {
  Sole sole;
  GroundBox& box = sole.options.ground.boxes.emplace_back();
  box.size_m = {0.3, 0.2, 0.04};
  box.X_WG = Translation3d(0.0, 0.0, 0.02);
  sole.place(Isometry3d(Translation3d(0.02, 0.01, 0.04 + 0.5 * kSole_m.z())));
  sole.run(1.0);
  EXPECT_NEAR(sole.position().z(), 0.04 + 0.5 * kSole_m.z(), 1e-4);
  EXPECT_LT(sole.velocity().norm(), 1e-4);
  double force_N = 0.0;
  for (const Contact& contact : sole.world->contacts()) {
    EXPECT_EQ(contact.other_link, -1);
    force_N += contact.f_W.z();
  }
  EXPECT_NEAR(force_N, kMass_kg * kGravity, 1e-3);
}

HeightField field_of(double (*height_m)(double x, double y)) {
  HeightField field;
  field.size_m = {0.6, 0.4};
  field.columns = 61;
  field.rows = 41;
  for (int row = 0; row < field.rows; ++row)
    for (int column = 0; column < field.columns; ++column)
      field.heights_m.push_back(height_m(-0.3 + 0.01 * column, -0.2 + 0.01 * row));
  return field;
}

TEST(HeightField, CarriesASoleOnALevelField) {
  Sole sole;
  sole.options.ground.height_fields.push_back(field_of([](double, double) { return 0.03; }));
  sole.place(Isometry3d(Translation3d(0.013, -0.007, 0.03 + 0.5 * kSole_m.z())));
  sole.run(1.0);
  EXPECT_NEAR(sole.position().z(), 0.03 + 0.5 * kSole_m.z(), 1e-4);
  EXPECT_LT(sole.velocity().norm(), 1e-4);
  EXPECT_EQ(sole.world->solver_warnings(), 0u);
}

// Ridges along y, 60 mm apart: the sole lies on two crests.
TEST(HeightField, CarriesASoleOnItsCrests) {
  Sole sole;
  sole.options.ground.present = false;
  sole.options.ground.height_fields.push_back(
      field_of([](double x, double) { return 0.005 * std::cos(2 * std::numbers::pi * x / 0.06); }));
  sole.place(Isometry3d(Translation3d(0.03, 0.0, 0.005 + 0.5 * kSole_m.z())));
  sole.run(1.0);
  EXPECT_NEAR(sole.position().z(), 0.005 + 0.5 * kSole_m.z(), 2e-4);
  EXPECT_LT(sole.velocity().norm(), 1e-3);
  const Isometry3d X_WB = sole.world->body(0).X_WL;
  EXPECT_GT(X_WB.linear()(2, 2), std::cos(0.01));
}

TEST(HeightField, SlopesLikeAPlane) {
  for (const double friction : {0.45, 0.25}) {
    Sole sole;
    sole.options.ground.present = false;
    sole.options.ground.height_fields.push_back(field_of([](double x, double) { return 0.35 * x; }));
    set_friction(sole.options.ground.height_fields[0].surface, friction, friction);
    const double angle_rad = std::atan(0.35);
    sole.place(Eigen::AngleAxisd(-angle_rad, Vector3d::UnitY()) * Translation3d(0.1, 0.0, 0.5 * kSole_m.z()));
    sole.run(0.05);
    const double start = sole.velocity().norm();
    sole.run(0.1);
    const double expected =
        friction < 0.35 ? kGravity * (std::sin(angle_rad) - friction * std::cos(angle_rad)) * 0.1 : 0.0;
    EXPECT_NEAR(sole.velocity().norm() - start, expected, 0.02 * expected + 1e-4);
  }
}

TEST(HeightField, EndsAtItsRim) {
  Sole sole;
  sole.options.ground.height_fields.push_back(field_of([](double, double) { return 0.03; }));
  sole.place(Isometry3d(Translation3d(0.4, 0.0, 0.5 * kSole_m.z())));
  sole.run(0.5);
  EXPECT_NEAR(sole.position().z(), 0.5 * kSole_m.z(), 1e-4);
}

}  // namespace
}  // namespace koboshi::sim_board
