#include "firmware/behaviour/fall_detector.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "firmware/fixed/host/convert.h"
#include "tests/support/factory_values.h"

namespace koboshi::behaviour {
namespace {

using fixed::from_double;

constexpr double kRadPerDegree = std::numbers::pi / 180.0;

struct LeanDegrees {
  double roll = 0.0;
  double pitch = 0.0;
  double roll_rate = 0.0;
  double pitch_rate = 0.0;
};

class FallDetectorTest : public testing::Test {
 protected:
  FallDirection see(const LeanDegrees& lean, std::optional<std::uint16_t> error_percent = std::nullopt) {
    return watch_.update(limits_,
                         {.roll_rate = from_double<fixed::AngularRate>(lean.roll_rate * kRadPerDegree),
                          .pitch_rate = from_double<fixed::AngularRate>(lean.pitch_rate * kRadPerDegree),
                          .roll = from_double<fixed::Angle>(lean.roll * kRadPerDegree),
                          .pitch = from_double<fixed::Angle>(lean.pitch * kRadPerDegree)},
                         error_percent);
  }
  // Returns the detected fall of an upright robot that takes this lean at once and keeps it.
  FallDirection after_standing(const LeanDegrees& lean, int cycles = 2,
                               std::optional<std::uint16_t> error_percent = std::nullopt) {
    watch_ = {};
    EXPECT_EQ(see({}), FallDirection::kNone);
    FallDirection seen = FallDirection::kNone;
    for (int i = 0; i < cycles && seen == FallDirection::kNone; ++i) seen = see(lean, error_percent);
    return seen;
  }

  FallLimits limits_ = test::kTestFallLimits;
  FallDetector watch_;
};

TEST_F(FallDetectorTest, NamesTheDirectionOfTheFall) {
  EXPECT_EQ(after_standing({.pitch = 27}), FallDirection::kFront);
  EXPECT_EQ(after_standing({.pitch = -27}), FallDirection::kBack);
  EXPECT_EQ(after_standing({.roll = 29}), FallDirection::kRight);
  EXPECT_EQ(after_standing({.roll = -29}), FallDirection::kLeft);
}

TEST_F(FallDetectorTest, AppliesTheLimitsOfTheParameters) {
  EXPECT_EQ(after_standing({.pitch = 25.9}, 10), FallDirection::kNone);
  EXPECT_EQ(after_standing({.pitch = -25.9}, 10), FallDirection::kNone);
  EXPECT_EQ(after_standing({.roll = 27.9}, 10), FallDirection::kNone);
  limits_.front = 10 * 65'536 / 360;
  limits_.min_lean = 5 * 65'536 / 360;
  EXPECT_EQ(after_standing({.pitch = 10.2}), FallDirection::kFront);
  EXPECT_EQ(after_standing({.pitch = -10.2}, 10), FallDirection::kNone);
}

TEST_F(FallDetectorTest, CombinesRateAndAngle) {
  // Predicted lean: 12 + 0.135 * 110 = 26.9 degrees.
  EXPECT_EQ(after_standing({.pitch = 12, .pitch_rate = 110}), FallDirection::kFront);
  EXPECT_EQ(after_standing({.pitch = 12, .pitch_rate = 95}, 10), FallDirection::kNone);
  EXPECT_EQ(after_standing({.roll = -12, .roll_rate = -130}), FallDirection::kLeft);
  // A large lean that is already decreasing.
  EXPECT_EQ(after_standing({.pitch = 28, .pitch_rate = -60}, 10), FallDirection::kNone);
}

// In units of the limits: half a second at 8,192 a second are 4,096, one more than the limit, or none.
TEST_F(FallDetectorTest, PredictsToTheUnit) {
  limits_ = {.front = 4'095, .back = 4'095, .side = 4'095, .lead_ms = 500, .min_lean = 1, .cycles = 1};
  const auto falls = [this](std::int16_t limit) {
    limits_.front = limits_.back = limits_.side = limit;
    std::vector<FallDirection> seen;
    for (const std::int32_t sign : {1, -1}) {
      const auto lean = fixed::Angle::from_raw(sign * (1 << 16));
      const auto rate = fixed::AngularRate::from_raw(sign * (8'190 << 8));
      for (const bool sagittal : {true, false}) {
        watch_ = {};
        EXPECT_EQ(see({}), FallDirection::kNone);
        estimation::TrunkMotion trunk{};
        (sagittal ? trunk.pitch : trunk.roll) = lean;
        (sagittal ? trunk.pitch_rate : trunk.roll_rate) = rate;
        seen.push_back(watch_.update(limits_, trunk));
      }
    }
    return seen;
  };
  using enum FallDirection;
  EXPECT_EQ(falls(4'095), (std::vector{kFront, kRight, kBack, kLeft}));
  EXPECT_EQ(falls(4'096), (std::vector{kNone, kNone, kNone, kNone}));
}

TEST_F(FallDetectorTest, CombinesTheAxesByAnEllipse) {
  EXPECT_EQ(after_standing({.roll = 19, .pitch = 18}, 10), FallDirection::kNone);
  EXPECT_EQ(after_standing({.roll = 19, .pitch = 20}), FallDirection::kFront);
  EXPECT_EQ(after_standing({.roll = 22, .pitch = -18}), FallDirection::kRight);
}

TEST_F(FallDetectorTest, IgnoresARateWithoutALean) {
  EXPECT_EQ(after_standing({.pitch = 9, .pitch_rate = 400}, 10), FallDirection::kNone);
}

TEST_F(FallDetectorTest, RequiresConsecutiveCycles) {
  limits_.cycles = 3;
  EXPECT_EQ(after_standing({.pitch = 30}, 2), FallDirection::kNone);
  EXPECT_EQ(see({.pitch = 5}), FallDirection::kNone);
  EXPECT_EQ(see({.pitch = 30}), FallDirection::kNone);
  EXPECT_EQ(see({.pitch = 30}), FallDirection::kNone);
  EXPECT_EQ(see({.pitch = 30}), FallDirection::kFront);
}

TEST_F(FallDetectorTest, DetectsAFallOnceAndNoneBeforeTheRobotWasUpright) {
  for (int i = 0; i < 20; ++i) EXPECT_EQ(see({.pitch = 90}), FallDirection::kNone);
  EXPECT_EQ(after_standing({.pitch = 30}), FallDirection::kFront);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(see({.pitch = 90}), FallDirection::kNone);
}

TEST_F(FallDetectorTest, DetectsAFallOfARobotInAStandingState) {
  EXPECT_EQ(see({.pitch = 90}), FallDirection::kNone);
  watch_.arm();
  EXPECT_EQ(see({.pitch = 90}), FallDirection::kNone);
  EXPECT_EQ(see({.pitch = 90}), FallDirection::kFront);
}

TEST_F(FallDetectorTest, IsOffWithoutALimit) {
  const FallLimits set = limits_;
  for (std::int16_t FallLimits::*limit :
       {&FallLimits::front, &FallLimits::back, &FallLimits::side, &FallLimits::min_lean}) {
    limits_ = set;
    limits_.*limit = 0;
    EXPECT_EQ(after_standing({.roll = 60, .pitch = 80}, 10), FallDirection::kNone);
  }
  limits_ = {};
  EXPECT_EQ(after_standing({.roll = 60, .pitch = 80}, 10), FallDirection::kNone);
}

// Twice the limits, because a step catches the lean, and the error that none catches.
TEST_F(FallDetectorTest, LetsARobotThatStepsLeanFurther) {
  limits_.walking_percent = 200;
  limits_.uncatchable_percent = 150;
  EXPECT_EQ(after_standing({.pitch = 50}, 10, 0), FallDirection::kNone);
  EXPECT_EQ(after_standing({.pitch = 54}, 2, 0), FallDirection::kFront);
  EXPECT_EQ(after_standing({.roll = -54}, 10, 0), FallDirection::kNone);
  EXPECT_EQ(after_standing({.roll = -58}, 2, 0), FallDirection::kLeft);
  // Without a measured error it is a robot that stands.
  EXPECT_EQ(after_standing({.pitch = 27}), FallDirection::kFront);
}

TEST_F(FallDetectorTest, TakesAnErrorThatNoStepCatchesForAFall) {
  limits_.walking_percent = 200;
  limits_.uncatchable_percent = 150;
  EXPECT_EQ(after_standing({.pitch = -12}, 10, 150), FallDirection::kNone);
  EXPECT_EQ(after_standing({.pitch = -12}, 2, 151), FallDirection::kBack);
  EXPECT_EQ(after_standing({.pitch = -12}, 1, 151), FallDirection::kNone);    // two cycles in a row
  EXPECT_EQ(after_standing({.pitch = -9}, 10, 1'000), FallDirection::kNone);  // less than the least lean
  limits_.uncatchable_percent = 0;
  EXPECT_EQ(after_standing({.pitch = -12}, 10, 60'000), FallDirection::kNone);
  EXPECT_EQ(after_standing({.pitch = 27}, 2, 0), FallDirection::kFront);
}

TEST_F(FallDetectorTest, AcceptsAnySensorValues) {
  for (const double angle : {-179.9, -90.0, 90.0, 179.9}) {
    for (const double rate : {-40'000.0, 40'000.0}) {
      after_standing({.roll = angle, .pitch = angle, .roll_rate = rate, .pitch_rate = rate});
    }
  }
  EXPECT_EQ(after_standing({.pitch = 85, .pitch_rate = 40'000}), FallDirection::kFront);
}

}  // namespace
}  // namespace koboshi::behaviour
