#include "view/capture/run_recording.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "simulation/record/recorder.h"
#include "simulation/scenario/reader.h"
#include "tests/support/temporary_folder.h"
#include "view/recording/read_recording.h"

namespace koboshi::view {
namespace {

// The end of a short run in which the robot settles on its chest and is pushed, and what a test compares its
// recording with.
struct Played {
  Recording recording;
  std::string bytes;
  std::vector<simulation::RunEvent> events;
  std::size_t frames = 0;
  double last_knee_rad = 0.0;  // at each sample of the period
  Eigen::Vector3d p_WB_W;      // at the end
};

class Frames final : public sim_board::BusObserver {
 public:
  explicit Frames(sim_board::BusObserver& next) : next_(next) {}
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override {
    ++count;
    next_.on_bus_frame(frame, start_us, end_us);
  }
  std::size_t count = 0;

 private:
  sim_board::BusObserver& next_;
};

simulation::Push push_on_trunk() {
  simulation::Push push;
  push.duration_us = 50'000;
  push.force_W_N.x() = 2.0;
  push.link.text = "trunk";
  return push;
}

Played play(std::uint64_t period_us) {
  const test::TemporaryFolder folder;
  const simulation::Scenario scenario = simulation::read_scenario(
      KOBOSHI_SOURCE_DIR "/scenarios/rise.yaml",
      std::vector<Override>{{"duration_s", "0.2"}, {"physics.stepper", "lumped"}, {"seed", "11"}});
  simulation::Simulation simulation(scenario);
  simulation.push(push_on_trunk());
  simulation::Recorder files(folder.path, simulation::RunRecorder::columns(simulation.robot()),
                             simulation::WhenFull::kWait);
  const std::filesystem::path file = folder.path / "run.mcap";
  RunRecording recording(file, simulation, {.period_us = period_us});
  Frames frames(recording);
  simulation::RunRecorder recorder(simulation, &files, &frames);
  while (!simulation.finished()) {
    simulation.advance();
    recorder.record();
    recording.record(recorder);
  }
  files.close();
  Played played;
  played.events = recorder.summary().events;
  recording.close(played.events);
  EXPECT_EQ(recording.dropped(), 0u);
  played.recording = read_recording(file);
  played.bytes = test::read_file(file);
  played.frames = frames.count;
  const int knee = *simulation.robot().find_joint("left_knee");
  played.last_knee_rad = simulation.board().world().joint(knee).position_rad;
  played.p_WB_W = recorder.truth().p_WB_W;
  return played;
}

const Played& at_100_Hz() {
  static const Played played = play(10'000);
  return played;
}

float value(const Recording& recording, const Sample& sample, const std::string& name) {
  const auto signal = std::ranges::find(recording.signals, name, &Signal::name);
  EXPECT_NE(signal, recording.signals.end()) << name;
  return sample.values.at(static_cast<std::size_t>(signal - recording.signals.begin()));
}

TEST(RunRecording, HasASampleForEachTick) {
  const Recording& recording = at_100_Hz().recording;
  EXPECT_TRUE(recording.complete);
  ASSERT_EQ(recording.samples.size(), 20u);
  for (std::size_t i = 0; i < recording.samples.size(); ++i)
    EXPECT_EQ(recording.samples[i].time_us, 10'000 * (i + 1));
  const Sample& last = recording.samples.back();
  EXPECT_FLOAT_EQ(value(recording, last, "left_knee_true"), static_cast<float>(at_100_Hz().last_knee_rad));
  EXPECT_EQ(last.links[0].p_WL_m, at_100_Hz().p_WB_W.cast<float>());
  EXPECT_FLOAT_EQ(value(recording, last, "true_base_z"), last.links[0].p_WL_m.z());
  EXPECT_NEAR(last.links[0].q_WL.norm(), 1.0F, 1e-6F);
}

TEST(RunRecording, TellsWhichRunItIs) {
  const Recording& recording = at_100_Hz().recording;
  EXPECT_EQ(recording.title, "rise");
  EXPECT_EQ(recording.seed, 11u);
  EXPECT_EQ(recording.stepper, "lumped");
  EXPECT_NE(recording.scenario.find("duration_s: 0.2\n"), std::string::npos);
  EXPECT_EQ(recording.scene.links.at(0).name, "trunk");
  ASSERT_GT(recording.nodes.size(), 20u) << "the controller, its drives and sensors";
  EXPECT_EQ(recording.nodes[0].id, 1);
  EXPECT_EQ(recording.nodes[0].name, "controller");
  EXPECT_NE(std::ranges::find(recording.nodes, "left_knee", &CanNode::name), recording.nodes.end());
}

TEST(RunRecording, HasAllFramesPushesAndEvents) {
  const Played& played = at_100_Hz();
  EXPECT_GT(played.frames, 100u);
  EXPECT_EQ(played.recording.frames.size(), played.frames);
  EXPECT_TRUE(std::ranges::is_sorted(played.recording.frames, {}, &Frame::end_us));
  ASSERT_EQ(played.recording.pushes.size(), 1u);
  EXPECT_EQ(played.recording.pushes[0].f_W_N, Eigen::Vector3d(2.0, 0.0, 0.0));
  EXPECT_EQ(played.recording.pushes[0].end_us, 50'000u);
  ASSERT_EQ(played.recording.events.size(), played.events.size());
  EXPECT_EQ(played.recording.events.back().text, played.events.back().text);
  EXPECT_EQ(played.recording.events.back().kind, "end");
}

TEST(RunRecording, HasPosesAndJointsBetweenTicks) {
  const Recording recording = play(2'000).recording;
  ASSERT_EQ(recording.samples.size(), 100u);
  // Each sample has poses and joints of its own. A joint may stick for a while, the trunk moves.
  std::size_t moved_trunks = 0;
  std::size_t moved_knees = 0;
  for (std::size_t i = 5; i < recording.samples.size(); ++i) {
    const Sample& sample = recording.samples[i];
    const Sample& before = recording.samples[i - 1];
    if (sample.links[0].p_WL_m != before.links[0].p_WL_m) ++moved_trunks;
    for (const char* knee : {"left_knee_true", "right_knee_true"})
      if (value(recording, sample, knee) != value(recording, before, knee)) ++moved_knees;
    if (sample.time_us % 10'000 != 0) {
      EXPECT_EQ(value(recording, sample, "left_knee_target"), value(recording, before, "left_knee_target"));
    }
  }
  EXPECT_GT(moved_trunks, 90u);
  EXPECT_GT(moved_knees, 50u);
  // The same run: its samples at ticks are those of 100 Hz.
  for (std::size_t tick = 0; tick < at_100_Hz().recording.samples.size(); ++tick) {
    const Sample& here = recording.samples[5 * tick + 4];
    const Sample& there = at_100_Hz().recording.samples[tick];
    EXPECT_EQ(here.time_us, there.time_us);
    EXPECT_EQ(here.links[3].p_WL_m, there.links[3].p_WL_m);
  }
}

// A ball falls beside the robot: 0.2 s of free fall.
TEST(RunRecording, HasTheLooseBodies) {
  const test::TemporaryFolder folder;
  simulation::Simulation simulation(simulation::read_scenario(
      KOBOSHI_SOURCE_DIR "/scenarios/rise.yaml",
      std::vector<Override>{
          {"duration_s", "0.2"},
          {"bodies", "[{name: ball, diameter_m: 0.1, mass_kg: 0.1, position_m: [1, 2], height_m: 3}]"}}));
  const std::filesystem::path file = folder.path / "run.mcap";
  RunRecording recording(file, simulation, {});
  simulation::RunRecorder recorder(simulation, nullptr, &recording, simulation::RunRecorder::Rows::kAlways);
  while (!simulation.finished()) {
    simulation.advance();
    recorder.record();
    recording.record(recorder);
  }
  recording.close(recorder.summary().events);
  const Recording read = read_recording(file);
  const std::size_t links = simulation.robot().links.size();
  ASSERT_EQ(read.scene.links.size(), links + 1);
  EXPECT_EQ(read.scene.links.back().name, "ball");
  ASSERT_EQ(read.samples.back().links.size(), links + 1);
  const Eigen::Vector3f& p_m = read.samples.back().links.back().p_WL_m;
  EXPECT_NEAR(p_m.x(), 1.0F, 1e-5F);
  EXPECT_NEAR(p_m.y(), 2.0F, 1e-5F);
  EXPECT_NEAR(p_m.z(), 3.0F - 0.5F * 9.80665F * 0.04F, 1e-3F);
}

TEST(RunRecording, HasTheSameBytesInEveryRun) { EXPECT_EQ(play(10'000).bytes, at_100_Hz().bytes); }

// Counts what it hears.
class Listener final : public RecordingListener {
 public:
  void add_sample(std::uint64_t time_us, std::span<const Pose> links, std::span<const ContactForce>,
                  std::span<const float> values) override {
    times_us.push_back(time_us);
    last_base_m = links[0].p_WL_m;
    last_values.assign(values.begin(), values.end());
  }
  void add_event(const Event& event) override { last_event = event.text; }
  void add_push(const Push& push) override { pushes.push_back(push); }
  void add_frame(const Frame&) override { ++frames; }

  std::vector<std::uint64_t> times_us;
  Eigen::Vector3f last_base_m;
  std::vector<float> last_values;
  std::string last_event;
  std::vector<Push> pushes;
  std::size_t frames = 0;
};

// A listener hears the ticks of what the file has, with or without a file.
TEST(RunRecording, TellsAListener) {
  const simulation::Scenario scenario = simulation::read_scenario(
      KOBOSHI_SOURCE_DIR "/scenarios/rise.yaml",
      std::vector<Override>{{"duration_s", "0.2"}, {"physics.stepper", "lumped"}, {"seed", "11"}});
  simulation::Simulation simulation(scenario);
  simulation.push(push_on_trunk());
  Listener listener;
  RunRecording recording({}, simulation, {.period_us = 2'000, .listener = &listener});
  simulation::RunRecorder recorder(simulation, nullptr, &recording, simulation::RunRecorder::Rows::kAlways);
  while (!simulation.finished()) {
    simulation.advance();
    recorder.record();
    recording.record(recorder);
  }
  const std::vector<simulation::RunEvent> events = recorder.summary().events;
  recording.close(events);
  ASSERT_EQ(listener.times_us.size(), 20u);
  EXPECT_EQ(listener.times_us.front(), 10'000u);
  EXPECT_EQ(listener.times_us.back(), 200'000u);
  EXPECT_EQ(listener.last_values.size(), at_100_Hz().recording.signals.size());
  EXPECT_EQ(listener.frames, at_100_Hz().frames);
  EXPECT_EQ(listener.pushes.size(), 1u);
  EXPECT_EQ(listener.last_event, events.back().text);
}

TEST(RunRecording, TellsOfABoardWithoutController) {
  simulation::BoardWithoutController board(simulation::read_scenario(
      KOBOSHI_SOURCE_DIR "/scenarios/board.yaml",
      std::vector<Override>{{"duration_s", "0.5"},
                            {"pushes", "[{at_s: 0.1, link: trunk, force_N: [1, 0, 0], duration_s: 0.1}]"}}));
  const Recording head = recording_head(board);
  EXPECT_EQ(head.title, "board");
  ASSERT_EQ(head.signals.size(), 3 + board.robot().joints.size());
  Listener listener;
  RunRecording recording(board, listener);
  board.board().electronics().bus().set_observer(&recording);
  while (!board.finished()) {
    board.advance();
    recording.record();
  }
  board.board().electronics().bus().set_observer(nullptr);
  recording.close({});
  EXPECT_EQ(listener.times_us.size(), 50u);
  EXPECT_GT(listener.frames, 0u);  // the boot-up messages
  EXPECT_EQ(listener.pushes.size(), 1u);
  ASSERT_EQ(listener.last_values.size(), head.signals.size());
  EXPECT_EQ(listener.last_values[2], listener.last_base_m.z());
  EXPECT_FLOAT_EQ(listener.last_values[3],
                  static_cast<float>(std::as_const(board).board().world().joint(0).position_rad));
}

}  // namespace
}  // namespace koboshi::view
