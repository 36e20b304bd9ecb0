#include "view/render/overlay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/sample_recording.h"
#include "view/render/playback.h"

namespace koboshi::view {
namespace {

Overlays only(Overlay overlay) {
  Overlays overlays;
  overlays.add(overlay);
  return overlays;
}

// A recording whose foot stands on the ground at three places, for 0.5 s each, and flies between them.
Recording steps() {
  Recording recording = test::sample_recording(180);
  for (std::size_t i = 0; i < recording.samples.size(); ++i) {
    Sample& sample = recording.samples[i];
    const bool flies = i % 60 >= 50;
    sample.links[1] = {.p_WL_m = {0.2F * static_cast<float>(i / 60), 0.05F, flies ? 0.04F : 0.015F}};
    if (flies) sample.contacts.clear();
  }
  return recording;
}

TEST(Playback, InterpolatesBetweenSamples) {
  const Recording recording = test::sample_recording(10);
  const std::vector<Pose> poses = poses_at(recording, 25'000);
  EXPECT_NEAR(poses[0].p_WL_m.x(), 0.025F, 1e-6F);
  const float turn_rad = 2.0F * std::atan2(poses[0].q_WL.z(), poses[0].q_WL.w());
  EXPECT_NEAR(turn_rad, 0.05F, 1e-5F);
  EXPECT_EQ(poses_at(recording, 0)[0].p_WL_m, recording.samples.front().links[0].p_WL_m);
  EXPECT_EQ(poses_at(recording, 9'000'000)[0].p_WL_m, recording.samples.back().links[0].p_WL_m);
}

TEST(Playback, FindsTheSampleOfATime) {
  const Recording recording = test::sample_recording(10);
  EXPECT_EQ(sample_at(recording, 0), 0U);
  EXPECT_EQ(sample_at(recording, 20'000), 1U);
  EXPECT_EQ(sample_at(recording, 29'999), 1U);
  EXPECT_EQ(sample_at(recording, 9'000'000), 9U);
}

TEST(Playback, WeighsLinksByMass) {
  const Recording recording = test::sample_recording(1);
  std::vector<Pose> poses(2);
  poses[1].p_WL_m = {0.7F, 0.0F, 0.0F};
  // 1.5 kg at (0, 0.01, 0.05) and 0.25 kg at (0.7, 0, 0).
  const Eigen::Vector3d expected_m =
      (1.5 * Eigen::Vector3d(0.0, 0.01, 0.05) + 0.25 * Eigen::Vector3d(0.7, 0, 0)) / 1.75;
  EXPECT_LT((centre_of_mass_W_m(recording.scene, poses) - expected_m).norm(), 1e-7);
}

TEST(Footprints, AreWhereASoleStood) {
  const std::vector<Footprint> prints = footprints(steps());
  ASSERT_EQ(prints.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& corner_m : prints[i].corners_W_m) centre_m += corner_m / 4.0;
    EXPECT_LT((centre_m - Eigen::Vector3d(0.2 * static_cast<double>(i), 0.05, 0.0)).norm(), 1e-6);
    EXPECT_EQ(prints[i].start_us, 10'000 + 600'000 * i);
    EXPECT_EQ(prints[i].end_us, 500'000 + 600'000 * i);
  }
}

TEST(Footprints, AreNotMadeBySlidingSoles) {
  EXPECT_TRUE(footprints(test::sample_recording()).empty());  // at 1 m/s
}

// A run that grows by any number of samples, and is rewound at any moment, has the footprints of its samples.
TEST(Footprints, FollowARunThatGrowsAndIsRewound) {
  const Recording whole = steps();
  std::mt19937 random(11);
  for (int run = 0; run < 50; ++run) {
    Recording recording = whole;
    recording.samples.clear();
    Footprints prints;
    std::size_t count = 0;
    while (count < whole.samples.size()) {
      std::size_t first = count;
      if (random() % 4 == 0) first = random() % (count + 1);  // a rewind
      count = std::min(first + random() % 40, whole.samples.size());
      recording.samples.assign(whole.samples.begin(),
                               whole.samples.begin() + static_cast<std::ptrdiff_t>(count));
      prints.follow(recording, first);
      const std::vector<Footprint> at_once = footprints(recording);
      const std::vector<Footprint> followed = prints.all();
      ASSERT_EQ(followed.size(), at_once.size()) << "seed 11, run " << run << ", " << count << " samples";
      for (std::size_t i = 0; i < at_once.size(); ++i) {
        ASSERT_EQ(followed[i].start_us, at_once[i].start_us);
        ASSERT_EQ(followed[i].end_us, at_once[i].end_us);
        ASSERT_EQ(followed[i].corners_W_m, at_once[i].corners_W_m);
      }
    }
  }
}

TEST(Footprints, OfAMomentAreThoseThatHaveNotFaded) {
  const Recording recording = steps();
  Footprints prints;
  prints.follow(recording, 0);
  EXPECT_EQ(prints.at(700'000, 8'000'000).size(), 2U);
  EXPECT_EQ(prints.at(700'000, 200'000).size(), 1U) << "the first one ended 200 ms before";
  EXPECT_EQ(prints.at(700'000, 200'001).size(), 2U);
  EXPECT_TRUE(prints.at(0, 8'000'000).empty());
}

// A solver may give one corner of a resting sole no force; the polygon has it all the same, unless the sole
// is off the ground there.
TEST(SupportPolygon, HasTheCornersThatTouch) {
  Recording recording = test::sample_recording(1);
  Scene& scene = recording.scene;
  scene.planes = {{.normal_W = Eigen::Vector3d::UnitZ(), .offset_m = 0.0}};
  scene.ground.clear();
  scene.sole_links = {1, -1};
  scene.soles_L[0] = {{0.05, 0.03, 0.0}, {-0.05, 0.03, 0.0}, {-0.05, -0.03, 0.0}, {0.05, -0.03, 0.0}};
  Sample& sample = recording.samples[0];
  sample.links[1] = {};
  sample.contacts.clear();
  for (const float x : {-0.05F, 0.05F})
    for (const float y : {-0.03F, 0.03F})
      sample.contacts.push_back(
          {.link = 1, .p_W_m = {x, y, 0.0F}, .f_W_N = {0.0F, 0.0F, x + y > 0.07F ? 0.0F : 1.0F}});
  EXPECT_EQ(support_polygon_W_m(scene, sample).size(), 4U);
  sample.links[1].p_WL_m.z() = 0.002F;
  EXPECT_EQ(support_polygon_W_m(scene, sample).size(), 3U);
  sample.contacts.clear();
  EXPECT_TRUE(support_polygon_W_m(scene, sample).empty());
}

TEST(OverlayMarks, FollowALiveRun) {
  const Recording whole = steps();
  Recording recording = whole;
  recording.samples.resize(1);
  OverlayMarks marks(recording, only(Overlay::kFootprints));
  EXPECT_TRUE(marks.at(500'000).flat.empty());
  recording.samples = whole.samples;
  marks.follow(1);
  EXPECT_FALSE(marks.at(500'000).flat.empty());
}

TEST(OverlayMarks, ShowAPushWhileItActs) {
  const Recording recording = test::sample_recording();
  const OverlayMarks marks(recording, only(Overlay::kPushes));
  EXPECT_TRUE(marks.at(1'190'000).solid.empty());
  EXPECT_TRUE(marks.at(1'300'000).solid.empty());
  const Marks during = marks.at(1'250'000);
  ASSERT_FALSE(during.solid.empty());
  // It ends 0.1 m above the trunk's origin, from behind, as long as its force of 5 N.
  float first_m = std::numeric_limits<float>::max();
  float last_m = std::numeric_limits<float>::lowest();
  for (const MarkVertex& vertex : during.solid) {
    first_m = std::min(first_m, vertex.p_W_m.x());
    last_m = std::max(last_m, vertex.p_W_m.x());
    EXPECT_NEAR(vertex.p_W_m.z(), 0.4F, 0.02F);
  }
  EXPECT_NEAR(last_m, 1.25F, 1e-4F);
  EXPECT_NEAR(last_m - first_m, 5.0F * static_cast<float>(kForceScale_m_per_N), 1e-4F);
}

TEST(OverlayMarks, ShowOnlyWhatWasChosenAndWhatHasAValue) {
  Recording recording = steps();
  for (const char* name : {"true_zmp_x", "true_zmp_y"})
    recording.signals.push_back({.name = name, .unit = "m"});
  for (Sample& sample : recording.samples) sample.values.insert(sample.values.end(), {0.3F, 0.1F});
  const std::size_t x = *find_signal(recording, "true_zmp_x");
  recording.samples[3].values[x] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(OverlayMarks(recording, Overlays()).at(30'000).solid.empty());
  const OverlayMarks marks(recording, only(Overlay::kZmp));
  EXPECT_TRUE(marks.at(40'000).solid.empty()) << "not a number";
  const Marks shown = marks.at(30'000);
  ASSERT_FALSE(shown.solid.empty());
  EXPECT_TRUE(shown.flat.empty());
  for (const MarkVertex& vertex : shown.solid)
    EXPECT_LT((vertex.p_W_m - Eigen::Vector3f(0.3F, 0.1F, 0.0F)).norm(), 0.013F);
}

TEST(OverlayMarks, FadeFootprintsAndForgetThem) {
  const Recording recording = steps();
  const OverlayMarks marks(recording, only(Overlay::kFootprints));
  const float young = marks.at(400'000).flat.front().colour[3];
  const float older = marks.at(1'700'000).flat.front().colour[3];
  EXPECT_GT(young, older);
  EXPECT_GT(older, 0.0F);
  EXPECT_TRUE(marks.at(60'000'000).flat.empty());
}

}  // namespace
}  // namespace koboshi::view
