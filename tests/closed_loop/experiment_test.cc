// Trials on the simulated robot: the building blocks of the experiments.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim_board/scenario/reader.h"
#include "sim_board/world/foot.h"
#include "tools/lab/catalogue/gyro_feedback.h"
#include "tools/lab/experiment/report.h"
#include "tools/lab/trial/scenario_trial.h"

namespace koboshi::tools {
namespace {

const std::filesystem::path kWalk = std::filesystem::path(KOBOSHI_SOURCE_DIR) / "scenarios/walk.yaml";

TEST(GyroFeedback, ComesToTheSameOnOneCoreAndOnTwo) {
  const Experiment experiment = make_gyro_feedback({.scenario = kWalk,
                                                    .overrides = {{"duration_s", "5.5"}},
                                                    .points = {8},
                                                    .feedback = {true},
                                                    .disturbed = true,
                                                    .seeds = 2});
  const std::string alone = to_csv(experiment, play_experiment(experiment, {.jobs = 1}));
  EXPECT_EQ(to_csv(experiment, play_experiment(experiment, {.jobs = 2})), alone);
  const std::size_t first = alone.find("\n8,on,1,");
  const std::size_t second = alone.find("\n8,on,2,");
  ASSERT_NE(second, std::string::npos) << alone;
  EXPECT_NE(alone.substr(first + 8, second - first - 8), alone.substr(second + 8))
      << "seeds make no difference";
}

TEST(GyroFeedback, ChangesTheWorldAndNotWhatTheFirmwareKnows) {
  const GyroFeedbackOptions options{.scenario = kWalk, .disturbed = true};
  const sim::Scenario plain = gyro_feedback_scenario(options, 8, true);
  const SeededWorld world = seeded_world(plain, options, 5);
  const simulation::Simulation nominal(plain);
  const simulation::Simulation changed(world.scenario, simulation::in_process(), world.change);
  EXPECT_EQ(changed.model().image, nominal.model().image);
  const double mass_kg = nominal.robot().total_mass_kg();
  EXPECT_NE(changed.robot().total_mass_kg(), mass_kg);
  EXPECT_NEAR(changed.robot().total_mass_kg(), mass_kg, 0.05 * mass_kg);
  EXPECT_FALSE(world.scenario.pushes.empty());
}

TEST(ScenarioTrial, TellsWhyItEnded) {
  const std::vector<sim::Override> overrides{{"duration_s", "1"},
                                             {"faults", "[{at_s: 0, kind: controller_stop}]"}};
  const sim::Scenario scenario =
      sim::read_scenario(std::filesystem::path(KOBOSHI_SOURCE_DIR) / "scenarios/go.yaml", overrides);
  const Values values = play_scenario(scenario, {});
  EXPECT_EQ(values.at("failed"), 1.0);
  EXPECT_THAT(values.error, testing::HasSubstr("the controller does not take"));
}

// Returns the mean height of all corners of both soles while the robot stands, just before it walks. The mean
// equals the static compression of the contact springs and does not depend on the lean.
double mean_corner_height_m(const sim::Scenario& scenario) {
  simulation::Simulation simulation(scenario);
  while (!simulation.finished()) simulation.advance();
  double sum_m = 0.0;
  double corners = 0.0;
  for (const auto& foot : sim::feet_of(simulation.robot())) {
    const Eigen::Isometry3d X_WL = simulation.board().world().body(foot.value().link).X_WL;
    for (const Eigen::Vector3d& p_L : foot->corners_L) {
      sum_m += (X_WL * p_L).z();
      corners += 1.0;
    }
  }
  return sum_m / corners;
}

TEST(SoftGround, GivesWayByWeightOverStiffness) {
  const std::vector<sim::Override> overrides{{"duration_s", "3.45"}};
  sim::Scenario scenario = sim::read_scenario(kWalk, overrides);
  const double hard_m = mean_corner_height_m(scenario);
  constexpr double kStiffness_N_per_m = 2000.0;
  constexpr double kContacts = 8.0;  // four per sole
  scenario.ground.softness = {kStiffness_N_per_m, 30.0};
  const double weight_N = simulation::Simulation(scenario).robot().total_mass_kg() * 9.80665;
  EXPECT_NEAR(hard_m - mean_corner_height_m(scenario), weight_N / (kContacts * kStiffness_N_per_m), 5e-5);
}

}  // namespace
}  // namespace koboshi::tools
