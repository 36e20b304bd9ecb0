#include "firmware/behaviour/lying_pose.h"

#include "firmware/fixed/literals.h"

namespace koboshi::behaviour {

using namespace fixed::literals;

namespace {

constexpr fixed::Ratio kUprightCosine = 0.966_ratio;  // 15 degrees
constexpr fixed::Ratio kUpCosine = 0.866_ratio;       // 30
constexpr fixed::Ratio kSittingCosine = 0.6_ratio;    // 53
constexpr fixed::Ratio kDownCosine = 0.5_ratio;       // 60
constexpr fixed::Angle kRaisedThigh = -45.0_deg;
// A trunk that lies on a shoulder and its chest rolls on to its chest by itself as soon as an arm moves: a
// side counts from 55 degrees of turn, tan 55 = 1.43 = 10 / 7.
constexpr int kSideNumerator = 7;
constexpr int kSideDenominator = 10;

}  // namespace

LyingPose classify(const robot::Direction& up_B, fixed::Angle thigh_pitch) {
  if (up_B.z > kSittingCosine && thigh_pitch < kRaisedThigh) return LyingPose::kSitting;
  if (is_upright(up_B)) return LyingPose::kUpright;
  const std::int64_t across_raw = std::int64_t{fixed::abs(up_B.y).raw()} * kSideNumerator;
  const std::int64_t along_raw = std::int64_t{fixed::abs(up_B.x).raw()} * kSideDenominator;
  if (across_raw > along_raw) return up_B.y.raw() < 0 ? LyingPose::kLeftSide : LyingPose::kRightSide;
  return up_B.x.raw() < 0 ? LyingPose::kProne : LyingPose::kSupine;
}

bool is_upright(const robot::Direction& up_B) { return up_B.z > kUprightCosine; }

bool is_down(const robot::Direction& up_B) { return up_B.z < kDownCosine; }

bool can_rest_on_feet(const robot::Direction& up_B) { return up_B.z > kUpCosine; }

}  // namespace koboshi::behaviour
