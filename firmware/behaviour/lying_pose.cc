#include "firmware/behaviour/lying_pose.h"

#include "firmware/behaviour/posture.h"
#include "firmware/fixed/literals.h"

namespace koboshi::behaviour {

using namespace fixed::literals;

namespace {

// Limits between poses that are far apart, set by hand (2026-11-22) like those of posture.h;
// docs/design/getting-up.md says what follows from each pose.
constexpr fixed::Angle kRaisedThigh = -45.0_deg;
// The robot lies on its side if the trunk is turned by more than 55 degrees from chest or back, tan 55 deg =
// 1.43 = 10 / 7. With less, it lies on a shoulder and the chest, and rolls onto the chest as soon as an arm
// moves.
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

bool can_rest_on_feet(const robot::Direction& up_B) { return up_B.z > kRestsOnFeetCosine; }

}  // namespace koboshi::behaviour
