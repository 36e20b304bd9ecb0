// Trials of the real robot: what an experiment builds on.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lab/catalogue/gyro_feedback.h"
#include "lab/experiment/report.h"
#include "lab/trial/scenario_trial.h"
#include "sim_board/world/foot.h"
#include "simulation/scenario/reader.h"

namespace koboshi::tools {
namespace {

const std::filesystem::path kWalk = std::filesystem::path(KOBOSHI_SOURCE_DIR) / "scenarios/walk.yaml";

TEST(GyroFeedback, IsIndependentOfTheNumberOfCores) {
  lab::GyroFeedbackOptions options;
  options.scenario = kWalk;
  options.overrides = {{"duration_s", "5.5"}};
  options.points = {8};
  options.feedback = {true};
  options.disturbed = true;
  options.seeds = 2;
  const lab::Experiment experiment = lab::make_gyro_feedback(options);
  const std::string alone = lab::to_csv(experiment, lab::play_experiment(experiment, {.jobs = 1}));
  EXPECT_EQ(lab::to_csv(experiment, lab::play_experiment(experiment, {.jobs = 2})), alone);
  const std::size_t first = alone.find("\n8,on,1,");
  const std::size_t second = alone.find("\n8,on,2,");
  ASSERT_NE(second, std::string::npos) << alone;
  EXPECT_NE(alone.substr(first + 8, second - first - 8), alone.substr(second + 8))
      << "seeds make no difference";
}

TEST(GyroFeedback, ChangesTheMotionButNotTheEstimate) {
  lab::GyroFeedbackOptions options;
  options.scenario = kWalk;
  options.disturbed = true;
  const simulation::Scenario plain = lab::gyro_feedback_scenario(options, 8, true);
  const simulation::Scenario seeded = lab::seeded_walk(plain, options, 5);
  const simulation::Simulation nominal(plain);
  const simulation::Simulation changed(seeded);
  EXPECT_EQ(changed.model().image, nominal.model().image);
  const double mass_kg = nominal.robot().total_mass_kg();
  EXPECT_NE(changed.robot().total_mass_kg(), mass_kg);
  EXPECT_NEAR(changed.robot().total_mass_kg(), mass_kg, 0.1 * mass_kg);
  EXPECT_FALSE(seeded.pushes.empty());
}

TEST(ScenarioTrial, ReportsWhyItEnded) {
  const std::vector<Override> overrides{{"duration_s", "1"},
                                        {"faults", "[{at_s: 0, kind: controller_stop}]"}};
  const simulation::Scenario scenario =
      simulation::read_scenario(std::filesystem::path(KOBOSHI_SOURCE_DIR) / "scenarios/go.yaml", overrides);
  const lab::ScenarioTrial trial = lab::play_scenario(scenario, {});
  EXPECT_EQ(trial.outcome, lab::Outcome::kFailed);
  EXPECT_THAT(trial.error, testing::HasSubstr("the controller does not take"));
}

// Mean height of the corners of both soles when the robot stands by itself, just before it walks: whichever
// way it leans, that is what the springs under the corners give.
double mean_corner_height_m(const simulation::Scenario& scenario) {
  simulation::Simulation simulation(scenario);
  while (!simulation.finished()) simulation.advance();
  double sum_m = 0.0;
  double corners = 0.0;
  for (const auto& foot : sim_board::feet_of(simulation.robot())) {
    const Eigen::Isometry3d X_WL = simulation.board().world().body(foot.value().link).X_WL;
    for (const Eigen::Vector3d& p_L : foot->corners_L) {
      sum_m += (X_WL * p_L).z();
      corners += 1.0;
    }
  }
  return sum_m / corners;
}

TEST(SoftGround, SinksByWeightOverStiffness) {
  const std::vector<Override> overrides{{"duration_s", "3.45"}};
  simulation::Scenario scenario = simulation::read_scenario(kWalk, overrides);
  const double hard_m = mean_corner_height_m(scenario);
  constexpr double kStiffness_N_per_m = 2000.0;
  constexpr double kContacts = 8.0;  // four a sole
  scenario.ground.softness = {kStiffness_N_per_m, 30.0};
  const double weight_N = simulation::Simulation(scenario).robot().total_mass_kg() * 9.80665;
  EXPECT_NEAR(hard_m - mean_corner_height_m(scenario), weight_N / (kContacts * kStiffness_N_per_m), 5e-5);
}

}  // namespace
}  // namespace koboshi::tools
