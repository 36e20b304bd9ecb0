#include "studio/soles/sole_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim_board/world/gravity.h"
#include "view/render/playback.h"

namespace koboshi::studio {
namespace {

constexpr double kSpeed_m_per_s = 0.2;
constexpr double kHeight_m = 0.3;  // of the trunk, which has all the mass
constexpr std::uint64_t kTickLength_us = 10'000;

// A robot of a trunk and two feet that looks along +y. The trunk moves forward by 0.2 m/s; at the time 0 it
// is above the middle between the feet, which rest at (1, 2 m). The left foot is off the ground.
view::Recording striding_recording(std::size_t samples = 200) {
  view::Recording recording;
  recording.scene.links = {{.name = "trunk", .mass_kg = 2.0}, {.name = "left"}, {.name = "right"}};
  recording.scene.sole_links = {1, 2};
  for (auto& sole_L : recording.scene.soles_L)
    sole_L = {{0.06, 0.03, 0.0}, {-0.04, 0.03, 0.0}, {-0.04, -0.03, 0.0}, {0.06, -0.03, 0.0}};
  recording.signals = {{.name = "zmp_x", .unit = "m"}, {.name = "zmp_y", .unit = "m"}};
  const Eigen::Quaternionf left_turn(
      Eigen::AngleAxisf(0.5F * std::numbers::pi_v<float>, Eigen::Vector3f::UnitZ()));
  for (std::size_t i = 0; i < samples; ++i) {
    view::Sample sample{.time_us = i * kTickLength_us};
    const auto ahead_m = static_cast<float>(1e-6 * kSpeed_m_per_s * static_cast<double>(sample.time_us));
    // The sole's middle is 0.01 m ahead of its link.
    sample.links = {{{1.0F, 2.01F + ahead_m, static_cast<float>(kHeight_m)}, left_turn},
                    {{0.95F, 2.0F, 0.02F}, left_turn},
                    {{1.05F, 2.0F, 0.0F}, left_turn}};
    for (const Eigen::Vector3d& corner_L : recording.scene.soles_L[1])
      sample.contacts.push_back({.link = 2,
                                 .p_W_m = sample.links[2].p_WL_m + left_turn * corner_L.cast<float>(),
                                 .f_W_N = {0.0F, 0.0F, 5.0F}});
    sample.values = {1.05F, 2.01F};
    if (i == 50) sample.values[0] = std::nanf("");
    recording.samples.push_back(std::move(sample));
  }
  return recording;
}

const SolePoint* find_point(const SolePicture& picture, SolePoint::Kind kind) {
  const auto found = std::ranges::find(picture.points, kind, &SolePoint::kind);
  return found == picture.points.end() ? nullptr : &*found;
}

TEST(SolePicture, HasForwardAndLeftOfTheSoles) {
  const auto picture = sole_picture(striding_recording(), 1'500'000);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->carry, (std::array{false, true}));
  for (const auto& [side, middle_y_m] : {std::pair(0, 0.05), std::pair(1, -0.05)}) {
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner_m : picture->soles_m[static_cast<std::size_t>(side)])
      middle_m += 0.25 * corner_m;
    EXPECT_LT((middle_m - Eigen::Vector2d(0.0, middle_y_m)).norm(), 1e-6) << side;
  }
  // The right sole alone carries.
  ASSERT_EQ(picture->support_m.size(), 4U);
  for (const Eigen::Vector2d& corner_m : picture->support_m) {
    EXPECT_NEAR(std::abs(corner_m.x()), 0.05, 1e-6);
    EXPECT_NEAR(std::abs(corner_m.y() + 0.05), 0.03, 1e-6);
  }
}

TEST(SolePicture, HasZmpAndMargin) {
  const auto picture = sole_picture(striding_recording(), 1'500'000);
  const SolePoint* zmp = find_point(*picture, SolePoint::Kind::kZmp);
  ASSERT_NE(zmp, nullptr);
  EXPECT_EQ(zmp->mark, &view::kZmpMarks[1]);
  EXPECT_LT((zmp->now_m - Eigen::Vector2d(0.0, -0.05)).norm(), 1e-6);
  EXPECT_EQ(zmp->trail_m.size(), 101U);
  EXPECT_TRUE(std::isnan(zmp->trail_m.front().x())) << "sample 50 has no value";
  ASSERT_TRUE(picture->margin_m);
  EXPECT_NEAR(*picture->margin_m, 0.03, 1e-6);
  EXPECT_EQ(picture->judged, zmp->mark);
}

TEST(SolePicture, HasCentreOfMassAndCapturePoint) {
  const view::Recording recording = striding_recording();
  const double reach_m = kSpeed_m_per_s * std::sqrt(kHeight_m / sim_board::kGravity_m_per_s2);
  for (const std::uint64_t time_us :
       {std::uint64_t{0}, std::uint64_t{700'000}, recording.samples.back().time_us}) {
    const auto picture = sole_picture(recording, time_us);
    const double ahead_m = 1e-6 * kSpeed_m_per_s * static_cast<double>(time_us);
    const SolePoint* com = find_point(*picture, SolePoint::Kind::kCom);
    const SolePoint* capture = find_point(*picture, SolePoint::Kind::kCapturePoint);
    ASSERT_TRUE(com != nullptr && capture != nullptr);
    EXPECT_LT((com->now_m - Eigen::Vector2d(ahead_m, 0.0)).norm(), 1e-5) << time_us;
    EXPECT_LT((capture->now_m - Eigen::Vector2d(ahead_m + reach_m, 0.0)).norm(), 1e-4) << time_us;
    EXPECT_EQ(com->trail_m.size(), std::min<std::uint64_t>(time_us / kTickLength_us, 100) + 1);
  }
}

TEST(SolePicture, IsEmptyWithoutSoles) {
  view::Recording recording = striding_recording(3);
  recording.scene.sole_links = {-1, -1};
  EXPECT_FALSE(sole_picture(recording, 0));
  EXPECT_FALSE(sole_picture(view::Recording(), 0));
}

TEST(SolePicture, OfOneSampleHasNoCapturePoint) {
  const auto picture = sole_picture(striding_recording(1), 0);
  EXPECT_EQ(find_point(*picture, SolePoint::Kind::kCapturePoint), nullptr);
  EXPECT_NE(find_point(*picture, SolePoint::Kind::kCom), nullptr);
}

}  // namespace
}  // namespace koboshi::studio
