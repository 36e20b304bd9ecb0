#include "studio/run/recording_window.h"

#include <gtest/gtest.h>

#include <thread>

#include "studio/run/overview_reader.h"
#include "tests/support/sample_recording.h"
#include "tests/support/temporary_folder.h"
#include "view/recording/recording_file.h"

namespace koboshi::studio {
namespace {

class RecordingWindowTest : public ::testing::Test {
 protected:
  RecordingWindowTest() {
    view::write_recording(folder.path / "run.mcap", whole);
    window.emplace(folder.path);
  }
  view::Recording shown() const {
    view::Recording recording = window->head();
    window->copy_to(recording);
    return recording;
  }
  // Whether the window holds the samples before and after a time as the whole recording does.
  void expect_sample(std::uint64_t time_us) {
    const view::Recording recording = shown();
    const auto at = [time_us](const view::Recording& one) {
      return std::ranges::upper_bound(one.samples, time_us, {}, &view::Sample::time_us);
    };
    const auto wanted = at(whole);
    const auto found = at(recording);
    ASSERT_EQ(found == recording.samples.begin(), wanted == whole.samples.begin()) << time_us;
    if (wanted != whole.samples.begin()) {
      EXPECT_EQ((found - 1)->time_us, (wanted - 1)->time_us) << time_us;
      EXPECT_EQ((found - 1)->values, (wanted - 1)->values) << time_us;
    }
  }

  const view::Recording whole = test::sample_recording(6'000);  // a minute
  const test::TemporaryFolder folder;
  std::optional<RecordingWindow> window;
};

TEST_F(RecordingWindowTest, OpensWithoutReadingTheRun) {
  EXPECT_EQ(window->end_us(), whole.samples.back().time_us);
  EXPECT_EQ(window->head().signals.size(), whole.signals.size());
  // The block with the shapes only, and far less than the file.
  EXPECT_EQ(window->index().mcap().chunks_read(), 1u);
  EXPECT_LT(window->index().mcap().bytes_read(), std::filesystem::file_size(folder.path / "run.mcap") / 4);
  EXPECT_TRUE(shown().samples.empty());
}

TEST_F(RecordingWindowTest, ReadsTwoBlocksAfterAJump) {
  const auto read = [&] { return window->index().mcap().chunks_read(); };
  for (const std::uint64_t time_us : {30'500'000u, 3'004'000u, 59'999'999u, 12'000'000u}) {
    const std::size_t before = read();
    EXPECT_TRUE(window->show(time_us));
    EXPECT_LE(read() - before, 2u) << time_us;
    expect_sample(time_us);
  }
}

TEST_F(RecordingWindowTest, ReadsEachBlockOnceWhileTimeAdvances) {
  const std::size_t before = window->index().mcap().chunks_read();
  for (std::uint64_t time_us = 0; time_us <= window->end_us(); time_us += 33'000) {
    window->show(time_us);
    while (window->extend()) {
    }
    ASSERT_LE(window->block_count(), RecordingWindow::kMaxBlocks);
  }
  EXPECT_EQ(window->index().mcap().chunks_read() - before, window->index().blocks());
  expect_sample(window->end_us());
}

TEST_F(RecordingWindowTest, HoldsTheSamplesAtAnyTime) {
  std::uint64_t time_us = 0;
  for (int i = 0; i < 300; ++i) {
    time_us = (time_us + 7'654'321 * static_cast<std::uint64_t>(i)) % 61'000'000;
    window->show(time_us);
    expect_sample(std::min(time_us, window->end_us()));
    if (i % 3 == 0) window->extend();
    ASSERT_LE(window->block_count(), RecordingWindow::kMaxBlocks);
  }
}

TEST_F(RecordingWindowTest, HoldsPushesAndFramesAroundTheTime) {
  window->show(1'250'000);
  while (window->extend()) {
  }
  const view::Recording recording = shown();
  ASSERT_EQ(recording.pushes.size(), 1u);
  EXPECT_FALSE(recording.frames.empty());
  EXPECT_LT(recording.frames.size(), whole.frames.size() / 2);
  EXPECT_TRUE(std::ranges::is_sorted(recording.frames, {}, &view::Frame::end_us));
  EXPECT_TRUE(std::ranges::is_sorted(recording.samples, {}, &view::Sample::time_us));
}

TEST_F(RecordingWindowTest, OverviewIsTheWholeRunInOrder) {
  OverviewReader reader(folder.path);
  std::vector<view::Sample> samples;
  std::vector<view::Event> events;
  while (!reader.finished()) {
    const auto blocks = reader.take(3);
    if (blocks.empty()) std::this_thread::yield();
    for (const view::Recording& block : blocks) {
      samples.insert(samples.end(), block.samples.begin(), block.samples.end());
      events.insert(events.end(), block.events.begin(), block.events.end());
    }
  }
  EXPECT_EQ(reader.error(), "");
  ASSERT_EQ(samples.size(), whole.samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ASSERT_EQ(samples[i].time_us, whole.samples[i].time_us);
    ASSERT_EQ(samples[i].values, whole.samples[i].values);
    ASSERT_TRUE(samples[i].links.empty());
  }
  ASSERT_EQ(events.size(), whole.events.size());
  EXPECT_EQ(events.back().text, whole.events.back().text);
}

// A run that was killed has no index: the heads of its blocks are read instead.
TEST_F(RecordingWindowTest, OpensARecordingThatWasCutOff) {
  const std::string bytes = test::read_file(folder.path / "run.mcap");
  test::write_file(folder.path / "run.mcap", bytes.substr(0, bytes.size() / 2));
  window.emplace(folder.path);
  EXPECT_FALSE(window->head().complete);
  EXPECT_EQ(window->index().mcap().chunks_read(), 1u);
  EXPECT_GT(window->end_us(), 20'000'000u);
  EXPECT_LT(window->end_us(), 40'000'000u);
  window->show(15'000'000);
  expect_sample(15'000'000);
}

}  // namespace
}  // namespace koboshi::studio
