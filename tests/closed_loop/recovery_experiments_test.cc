// The experiments on falling and getting up in short.

#include <gtest/gtest.h>

#include "lab/catalogue/contacts.h"
#include "lab/catalogue/fall_detection.h"
#include "lab/catalogue/marathon.h"
#include "lab/catalogue/stand_up.h"
#include "lab/experiment/report.h"
#include "lab/trial/outcome.h"
#include "sim_board/description/load.h"
#include "sim_board/engine/make_world.h"

namespace koboshi::tools {
namespace {

template <typename Options>
Options short_recovery(std::size_t seeds) {
  Options options;
  options.scenario = KOBOSHI_SOURCE_DIR "/scenarios/get_up.yaml";
  options.overrides = {{"physics.stepper", "lumped"}};
  options.seeds = seeds;
  return options;
}

template <typename Options>
Options in_mujoco(std::size_t seeds, std::uint64_t first_seed) {
  auto options = short_recovery<Options>(seeds);
  options.overrides = {{"physics.stepper", "mujoco"}};
  options.first_seed = first_seed;
  return options;
}

TEST(StandUp, GetsUpFromEveryDroppedPose) {
  const auto options = short_recovery<lab::StandUpOptions>(2);
  const lab::Experiment experiment = lab::make_stand_up(options);
  const lab::ExperimentResult result = lab::play_experiment(experiment, {});
  const lab::Conclusions conclusions = experiment.conclude(experiment, result);
  EXPECT_EQ(conclusions.values.at("success_rate"), 1.0);
  for (const lab::StandUpTrial& trial : lab::stand_up_fields().trials(result.cells[0])) {
    EXPECT_GT(trial.time_s, 1.5);
    EXPECT_GT(trial.history.peak_torque_Nm, 0.5);
    // A motor makes twice its stall torque at most: driven backwards at its no-load speed.
    EXPECT_GT(trial.history.peak_motor_torque_Nm, 0.5);
    EXPECT_LT(trial.history.peak_motor_torque_Nm, 2.0 * 1.373);
  }
}

TEST(StandUp, StaysDownWithoutItsMotions) {
  auto options = short_recovery<lab::StandUpOptions>(1);
  options.overrides.push_back({"motions", "[robots/koboshi/motions/stand.yaml]"});
  const lab::Experiment experiment = lab::make_stand_up(options);
  const lab::ExperimentResult result = lab::play_experiment(experiment, {});
  EXPECT_EQ(experiment.conclude(experiment, result).values.at("success_rate"), 0.0);
}

// In these `rough` worlds the robot bounced on its feet at 10 Hz after it had got up, with three times its
// gain of the knees (docs/experiment/stand-up.md).
TEST(StandUp, ComesToRestOnceItIsUp) {
  if (!sim_board::has_mujoco()) GTEST_SKIP() << "built without MuJoCo";
  for (const std::uint64_t seed : {1'700'003u, 1'700'010u, 1'700'061u}) {
    auto options = in_mujoco<lab::StandUpOptions>(1, seed);
    options.world = "rough";
    const lab::Experiment experiment = lab::make_stand_up(options);
    const lab::ExperimentResult result = lab::play_experiment(experiment, {});
    const lab::StandUpTrial trial = lab::stand_up_fields().trials(result.cells[0]).at(0);
    EXPECT_FALSE(trial.not_at_once) << seed;
    EXPECT_LT(trial.time_s, 4.0) << seed;
  }
}

TEST(FallDetection, PredictsFallsFromPushesAndNoneWhileWalking) {
  auto options = short_recovery<lab::FallDetectionOptions>(1);
  options.walk_s = 6.0;
  const lab::Experiment experiment = lab::make_fall_detection(options);
  const lab::ExperimentResult result = lab::play_experiment(experiment, {});
  const lab::Conclusions conclusions = experiment.conclude(experiment, result);
  EXPECT_EQ(conclusions.values.at("false_alarms_per_10_min"), 0.0);
  EXPECT_NEAR(conclusions.values.at("walked_s").get<double>(), 10.0, 0.1);
  EXPECT_GT(conclusions.values.at("lead_mean_s").get<double>(), 0.1);
  EXPECT_TRUE(lab::fall_fields().trials(result.cells[0]).at(0).fell);
}

TEST(Marathon, StandsAtTheEnd) {
  auto options = short_recovery<lab::MarathonOptions>(1);
  options.hours = 0.03;
  const lab::Experiment experiment = lab::make_marathon(options);
  const lab::ExperimentResult result = lab::play_experiment(experiment, {});
  const lab::Conclusions conclusions = experiment.conclude(experiment, result);
  EXPECT_EQ(conclusions.values.at("stands_at_the_end"), 1);
  EXPECT_GT(conclusions.values.at("distance_m_total").get<double>(), 0.5);
}

// docs/experiment/contacts.md in short. With seed 10 a contact was 3.3 mm deep without a force, and 1 % of
// the steps unsettled, when the lifts were set to the slips three times.
TEST(Contacts, HoldInFallsAndInGettingUp) {
  if (!sim_board::has_mujoco()) GTEST_SKIP() << "built without MuJoCo";
  const auto options = in_mujoco<lab::ExperimentSetup>(2, 9);
  const lab::Experiment experiment = lab::make_contacts(options);
  const lab::ExperimentResult result = lab::play_experiment(experiment, {});
  const lab::FieldTable<lab::ContactsTrial> fields =
      lab::contacts_fields(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"));
  for (const lab::CellResult& cell : result.cells) {
    for (const lab::ContactsTrial& trial : fields.trials(cell))
      EXPECT_NE(trial.outcome, lab::Outcome::kSurvived);
  }
  const lab::Conclusions conclusions = experiment.conclude(experiment, result);
  EXPECT_LT(conclusions.values.at("deepest_without_force_m").get<double>(), 0.001);
  EXPECT_LT(conclusions.values.at("unsettled_share").get<double>(), 0.001);
  EXPECT_GT(conclusions.values.at("largest_overlap_m").get<double>(), 0.0);
  EXPECT_LT(conclusions.values.at("largest_overlap_m").get<double>(), 0.002);
}

// Two links meet at 2.5 m/s in this seed. They overlapped by 2.5 mm when a contact existed only after the
// step in which they met.
TEST(Contacts, SlowLinksDownBeforeTheyOverlap) {
  if (!sim_board::has_mujoco()) GTEST_SKIP() << "built without MuJoCo";
  lab::Experiment experiment = lab::make_contacts(in_mujoco<lab::ExperimentSetup>(1, 20096));
  const lab::ExperimentResult result = lab::play_experiment(experiment, {});
  const lab::Conclusions conclusions = experiment.conclude(experiment, result);
  EXPECT_LT(conclusions.values.at("largest_overlap_m").get<double>(), 0.0005);
}

}  // namespace
}  // namespace koboshi::tools
