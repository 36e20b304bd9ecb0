#include "view/film/caption.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/sample_recording.h"

namespace koboshi::view {
namespace {

Overlays all() {
  Overlays overlays;
  for (std::size_t i = 0; i < kOverlayNames.size(); ++i) overlays.add(static_cast<Overlay>(i));
  return overlays;
}

TEST(Caption, HasTimeStateAndTheLatestEvent) {
  const Recording recording = test::sample_recording();
  const Caption caption = caption_at(recording, all(), 1'250'000, 1.0);
  EXPECT_EQ(caption.time, "1.25 s");
  EXPECT_EQ(caption.title, "sample");
  EXPECT_EQ(caption.state, "standing");
  EXPECT_EQ(caption.event_time, "1.20 s");
  EXPECT_EQ(caption.event, "The trunk is pushed.");
  EXPECT_DOUBLE_EQ(caption.event_opacity, 1.0);
  EXPECT_EQ(caption_at(recording, all(), 700'000, 1.0).event, "Stands.");
}

TEST(Caption, ForgetsAnEventAndTellsTheSpeed) {
  const Recording recording = test::sample_recording();
  const Caption late = caption_at(recording, all(), 9'000'000, 0.5);
  EXPECT_TRUE(late.event.empty());
  EXPECT_EQ(late.title, "sample, speed 0.5");
  EXPECT_TRUE(caption_at(recording, all(), 400'000, 1.0).event.empty()) << "before the first";
}

TEST(Caption, IsEmptyWithoutOverlays) {
  const Caption caption = caption_at(test::sample_recording(), Overlays(), 1'250'000, 1.0);
  EXPECT_TRUE(caption.time.empty() && caption.state.empty() && caption.event.empty() && caption.keys.empty());
}

TEST(Caption, ExplainsOnlyMarksThatTheRecordingHas) {
  const auto texts = [](const Recording& recording) {
    std::vector<std::string> result;
    for (const Caption::Key& key : caption_at(recording, all(), 1'250'000, 1.0).keys)
      result.push_back(key.text);
    result.resize(3);
    return result;
  };
  Recording recording = test::sample_recording();
  recording.signals = {{.name = "planned_zmp_x", .unit = "m"}, {.name = "planned_zmp_y", .unit = "m"}};
  EXPECT_EQ(texts(recording), (std::vector<std::string>{"ZMP planned", "centre of mass", "contact force"}));
  recording.signals = {{.name = "zmp_x", .unit = "m"}, {.name = "true_zmp_x", .unit = "m"}};
  EXPECT_EQ(texts(recording), (std::vector<std::string>{"ZMP measured", "true", "centre of mass"}));
}

// The feet of a robot in the middle stay visible.
TEST(Caption, KeepsALongEventInTheLeftOfThePicture) {
  constexpr std::size_t kWidth = 640;
  Canvas canvas(kWidth, 360);
  Caption caption = caption_at(test::sample_recording(), all(), 1'250'000, 1.0);
  for (int i = 0; i < 40; ++i) caption.event += " and so on";
  caption.keys.clear();
  draw_caption(canvas, caption, 500.0);
  const auto pixels = canvas.pixels();
  std::size_t ink = 0;
  for (std::size_t row = 270; row < 360; ++row) {
    for (std::size_t column = 0; column < kWidth; ++column) {
      const bool dark = pixels[4 * (kWidth * row + column)] < 128;
      ink += dark ? 1U : 0U;
      EXPECT_FALSE(dark && column > kWidth * 2 / 5) << row << ", " << column;
    }
  }
  EXPECT_GT(ink, 300U);
}

TEST(Caption, LeavesAllButTheCornersAlone) {
  Canvas canvas(640, 360);
  Caption caption = caption_at(test::sample_recording(), all(), 1'250'000, 1.0);
  for (int i = 0; i < 40; ++i) caption.event += " and so on";  // wider than the picture
  draw_caption(canvas, caption, 500.0);
  const auto pixels = canvas.pixels();
  const auto ink_in_rows = [&](std::size_t from, std::size_t to) {
    std::size_t count = 0;
    for (std::size_t i = 4 * 640 * from; i < 4 * 640 * to; i += 4) count += pixels[i] < 128 ? 1U : 0U;
    return count;
  };
  EXPECT_GT(ink_in_rows(0, 90), 100U);
  EXPECT_EQ(ink_in_rows(90, 270), 0U);
  EXPECT_GT(ink_in_rows(270, 360), 300U);
  for (std::size_t row = 0; row < 360; ++row)
    EXPECT_EQ(pixels[4 * (640 * row + 639)], 255) << "nothing runs out of the picture, row " << row;
}

}  // namespace
}  // namespace koboshi::view
