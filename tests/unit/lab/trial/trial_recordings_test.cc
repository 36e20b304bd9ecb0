#include "lab/trial/trial_recordings.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "lab/trial/scenario_trial.h"
#include "simulation/scenario/reader.h"
#include "tests/support/temporary_folder.h"
#include "view/recording/read_recording.h"

namespace koboshi::lab {
namespace {

simulation::Scenario short_scenario() {
  return simulation::read_scenario(
      KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml",
      std::vector<Override>{{"duration_s", "0.05"}, {"physics.stepper", "lumped"}});
}

TEST(TrialRecordings, AreKeptWhereTheTrialIsLost) {
  const koboshi::test::TemporaryFolder folder;
  const auto stem = folder.path / "lost" / "8-on-3";
  {
    TrialRecordings recordings(stem);
    for (int i = 0; i < 2; ++i) static_cast<void>(play_scenario(short_scenario(), {}));
    recordings.keep();
  }
  for (const char* name : {"8-on-3.mcap", "8-on-3-2.mcap"}) {
    const view::Recording recording = view::read_recording(folder.path / "lost" / name);
    EXPECT_TRUE(recording.complete);
    ASSERT_EQ(recording.samples.size(), 5u);
    EXPECT_EQ(recording.events.back().kind, "end");
  }
  EXPECT_EQ(TrialRecordings::of_this_thread(), nullptr);
}

TEST(TrialRecordings, AreRemovedOtherwise) {
  const koboshi::test::TemporaryFolder folder;
  {
    TrialRecordings recordings(folder.path / "8-on-3");
    static_cast<void>(play_scenario(short_scenario(), {}));
    EXPECT_TRUE(std::filesystem::exists(folder.path / "8-on-3.mcap"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

// A recording observes: the trial is the same.
TEST(TrialRecordings, DoNotChangeTheTrial) {
  const koboshi::test::TemporaryFolder folder;
  const ScenarioTrial plain = play_scenario(short_scenario(), {});
  TrialRecordings recordings(folder.path / "trial");
  const ScenarioTrial recorded = play_scenario(short_scenario(), {});
  EXPECT_EQ(recorded.duration_s, plain.duration_s);
  EXPECT_EQ(recorded.foot_slip_max_m, plain.foot_slip_max_m);
  EXPECT_EQ(recorded.faults, plain.faults);
}

}  // namespace
}  // namespace koboshi::lab
