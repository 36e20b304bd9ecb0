#include "sim_board/world/surface_contact.h"

#include <gtest/gtest.h>

namespace koboshi::sim_board {
namespace {

// Two materials that differ in everything.
const SurfaceDescription kRubber{.friction = 0.9,
                                 .friction_second = 0.4,
                                 .bounce = 0.1,
                                 .bounce_threshold_m_per_s = 0.02,
                                 .error_reduction = 0.3,
                                 .constraint_force_mixing = 2e-4,
                                 .reference_step_s = 0.001,
                                 .slip_m_per_N_s = 0.01,
                                 .friction_direction = {},
                                 .material = "rubber"};
const SurfaceDescription kWood{.friction = 0.5,
                               .friction_second = 0.6,
                               .bounce = 0.7,
                               .bounce_threshold_m_per_s = 0.05,
                               .error_reduction = 0.6,
                               .constraint_force_mixing = 1e-4,
                               .reference_step_s = 0.002,
                               .slip_m_per_N_s = 0.03,
                               .friction_direction = {},
                               .material = "wood"};
constexpr double kStep_s = 0.0005;

void expect_equal(const SurfaceContact& one, const SurfaceContact& other) {
  EXPECT_EQ(one.friction, other.friction);
  EXPECT_EQ(one.friction_second, other.friction_second);
  EXPECT_EQ(one.bounce, other.bounce);
  EXPECT_EQ(one.bounce_threshold_m_per_s, other.bounce_threshold_m_per_s);
  EXPECT_DOUBLE_EQ(one.softness.error_reduction, other.softness.error_reduction);
  EXPECT_DOUBLE_EQ(one.softness.constraint_force_mixing, other.softness.constraint_force_mixing);
  EXPECT_DOUBLE_EQ(one.slip_m_per_N_s, other.slip_m_per_N_s);
}

TEST(SurfaceContact, DependsOnBothSurfaces) {
  const SurfaceContact contact = contact_between(kRubber, kWood, kStep_s);
  EXPECT_EQ(contact.friction, 0.5);
  EXPECT_EQ(contact.friction_second, 0.4);
  EXPECT_EQ(contact.bounce, 0.7);
  EXPECT_EQ(contact.bounce_threshold_m_per_s, 0.05) << "that of the bouncier surface";
  EXPECT_DOUBLE_EQ(contact.slip_m_per_N_s, 0.04);
  // Springs and dampers in series, by the formulas of the header.
  const double spring_m_per_N = 0.001 * 2e-4 / 0.3 + 0.002 * 1e-4 / 0.6;
  const double damper_m_per_N_s = 2e-4 / 0.7 + 1e-4 / 0.4;
  const double step_stiffness = kStep_s / spring_m_per_N;
  EXPECT_NEAR(contact.softness.error_reduction, step_stiffness / (step_stiffness + 1.0 / damper_m_per_N_s),
              1e-12);
  EXPECT_NEAR(contact.softness.constraint_force_mixing, 1.0 / (step_stiffness + 1.0 / damper_m_per_N_s),
              1e-15);
}

TEST(SurfaceContact, DoesNotDependOnTheirOrder) {
  expect_equal(contact_between(kRubber, kWood, kStep_s), contact_between(kWood, kRubber, kStep_s));
  const MaterialPair pair{.between = {"rubber", "wood"},
                          .friction = std::array{0.3, 0.2},
                          .bounce = 0.05,
                          .bounce_threshold_m_per_s = 0.3,
                          .spring = MaterialPair::Spring{5000.0, 20.0},
                          .slip_m_per_N_s = 0.002};
  const SurfaceContact given = contact_between(kRubber, kWood, kStep_s, {&pair, 1});
  expect_equal(given, contact_between(kWood, kRubber, kStep_s, {&pair, 1}));
  EXPECT_EQ(given.friction, 0.3);
  EXPECT_EQ(given.friction_second, 0.2);
  EXPECT_EQ(given.bounce, 0.05);
  EXPECT_EQ(given.bounce_threshold_m_per_s, 0.3);
  EXPECT_EQ(given.slip_m_per_N_s, 0.002);
  EXPECT_DOUBLE_EQ(given.softness.error_reduction, 2.5 / 22.5);
  EXPECT_DOUBLE_EQ(given.softness.constraint_force_mixing, 1.0 / 22.5);
}

TEST(SurfaceContact, APairConcernsItsTwoMaterialsAlone) {
  for (const std::array<std::string, 2>& between : {std::array<std::string, 2>{"rubber", "rubber"},
                                                    {"wood", "wood"},
                                                    {"rubber", "ice"},
                                                    {"ice", "wood"}}) {
    const MaterialPair pair{.between = between,
                            .friction = std::array{0.3, 0.2},
                            .bounce = {},
                            .bounce_threshold_m_per_s = {},
                            .spring = {},
                            .slip_m_per_N_s = {}};
    expect_equal(contact_between(kRubber, kWood, kStep_s, {&pair, 1}),
                 contact_between(kRubber, kWood, kStep_s));
  }
}

// A file may give numbers whose spring or damper would have no inverse.
TEST(SurfaceContact, BoundsWhatHasNoInverse) {
  const auto with = [](double error_reduction, double constraint_force_mixing) {
    SurfaceDescription surface = kRubber;
    surface.error_reduction = error_reduction;
    surface.constraint_force_mixing = constraint_force_mixing;
    return contact_between(surface, kWood, kStep_s);
  };
  expect_equal(with(0.0, 2e-4), with(1e-6, 2e-4));
  expect_equal(with(1.0, 2e-4), with(0.999, 2e-4));
  expect_equal(with(0.3, 0.0), with(0.3, 1e-9));
  // The bounds go no further than they must.
  EXPECT_NE(with(0.0, 2e-4).softness.error_reduction, with(2e-6, 2e-4).softness.error_reduction);
  EXPECT_NE(with(1.0, 2e-4).softness.error_reduction, with(0.998, 2e-4).softness.error_reduction);
  EXPECT_NE(with(0.3, 0.0).softness.error_reduction, with(0.3, 2e-9).softness.error_reduction);
}

}  // namespace
}  // namespace koboshi::sim_board
