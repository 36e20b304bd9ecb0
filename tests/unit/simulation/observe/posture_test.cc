// When a robot stands, and that host and firmware judge by the same limits.

#include "simulation/observe/posture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/behaviour/posture.h"
#include "firmware/fixed/host/convert.h"

namespace koboshi::simulation {
namespace {

using behaviour::State;

GroundTruth upright() {
  GroundTruth truth;
  truth.pose_height_m = 0.25;
  truth.height_m = 0.25;
  return truth;
}

TEST(Posture, HasTheLimitsOfTheFirmware) {
  const auto degrees = [](fixed::Ratio cosine) {
    return std::acos(fixed::to_double(cosine)) * 180.0 / std::numbers::pi;
  };
  const double kRad = std::numbers::pi / 180.0;
  EXPECT_NEAR(degrees(behaviour::kUprightCosine) * kRad, kUpright_rad, 0.1 * kRad);
  EXPECT_NEAR(degrees(behaviour::kRestsOnFeetCosine) * kRad, kUpAgain_rad, 0.1 * kRad);
  EXPECT_NEAR(degrees(behaviour::kDownCosine) * kRad, kFallen_rad, 0.1 * kRad);
  EXPECT_NEAR(fixed::to_double(behaviour::kStillRate), kStill_rad_per_s, 1e-3);
}

TEST(Posture, IsOnItsFeetWhereControllerAndTruthSaySo) {
  GroundTruth truth = upright();
  for (const State state : {State::kStanding, State::kMotion, State::kWalking, State::kLowBattery})
    EXPECT_TRUE(is_on_its_feet(state, truth));
  for (const State state : {State::kSteadying, State::kRising, State::kLimp, State::kFalling, State::kFault})
    EXPECT_FALSE(is_on_its_feet(state, truth));
  truth.tilt_rad = kUpAgain_rad;
  EXPECT_FALSE(is_on_its_feet(State::kStanding, truth));
}

TEST(Posture, StandsStillOnlyUprightHighAndAtRest) {
  EXPECT_TRUE(stands_still(upright()));
  GroundTruth leans = upright();
  leans.tilt_rad = kUpright_rad;
  EXPECT_FALSE(stands_still(leans));
  GroundTruth sits = upright();
  sits.height_m = 0.19;
  EXPECT_FALSE(stands_still(sits));
  GroundTruth turns = upright();
  turns.w_WB_W.z() = kStill_rad_per_s;
  EXPECT_FALSE(stands_still(turns));
}

}  // namespace
}  // namespace koboshi::simulation
