#include "firmware/estimation/centre_of_mass.h"

#include <algorithm>

#include "firmware/fixed/gravity.h"
#include "firmware/fixed/literals.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::estimation {

using fixed::Length;
using fixed::Ratio;
using fixed::Speed;
using robot::Direction;
using namespace fixed::literals;

namespace {

constexpr Ratio kPositionGain = 0.3_ratio;
constexpr std::int32_t kVelocityGain_per_s = 5;
constexpr Ratio kObserved_s = 0.01_ratio;  // a cycle
constexpr Length kLowest = 0.05_m;
constexpr Length kHighest = 1.0_m;
constexpr Length kSameHeight = 0.001_m;

robot::Position from_sole(const Posture& posture, hal::Side side) {
  return posture.p_BCom - posture.X_BSole[side].p;
}

// The motion along one axis in one cycle.
void observe(Length& position, Speed& velocity, fixed::Acceleration force, Length measured) {
  const Speed gained = fixed::product<Speed>(force, kObserved_s);
  position += fixed::product<Length>(velocity + Speed::from_raw(gained.raw() / 2), kObserved_s);
  velocity += gained;
  const Length miss = measured - position;
  position += fixed::product<Length>(miss, kPositionGain);
  velocity += Speed::from_raw(miss.raw()) * kVelocityGain_per_s;
}

}  // namespace

const CentreOfMassMotion& CentreOfMassObserver::update(const Posture& posture,
                                                       const std::optional<LevelAxes>& axes,
                                                       const Direction& up_B,
                                                       const robot::Vector<fixed::Acceleration>& force_B,
                                                       hal::Side sole) {
  if (!axes) {
    motion_.valid = false;
    return motion_;
  }
  const robot::Position p_B = from_sole(posture, sole);
  const Length x = dot(axes->forward, p_B);
  const Length y = dot(axes->left, p_B);
  motion_.height = dot(up_B, p_B);
  if (!motion_.valid) {
    motion_ = {
        .valid = true, .sole = sole, .position = {x, y}, .height = motion_.height, .velocity = {}, .dcm = {}};
  } else if (motion_.sole != sole) {
    // What the observer knows beyond the joint angles is the same vector in both frames.
    const auto last = level_axes(posture.X_BSole[motion_.sole].R, up_B);
    if (last) {
      const robot::Position last_p_B = from_sole(posture, motion_.sole);
      const Length beyond_x = motion_.position.x - dot(last->forward, last_p_B);
      const Length beyond_y = motion_.position.y - dot(last->left, last_p_B);
      const Ratio cosine = dot(axes->forward, last->forward);
      const Ratio sine = dot(axes->forward, last->left);
      motion_.position = {x + fixed::product_sum<Length>(beyond_x, cosine, beyond_y, sine),
                          y + fixed::product_sum<Length>(beyond_y, cosine, -beyond_x, sine)};
      motion_.velocity = {fixed::product_sum<Speed>(motion_.velocity.x, cosine, motion_.velocity.y, sine),
                          fixed::product_sum<Speed>(motion_.velocity.y, cosine, -motion_.velocity.x, sine)};
    }
    motion_.sole = sole;
  }
  observe(motion_.position.x, motion_.velocity.x, dot(axes->forward, force_B), x);
  observe(motion_.position.y, motion_.velocity.y, dot(axes->left, force_B), y);
  // Within a millimetre of height, 0.3 % of the time constant, the last root will do.
  if (fixed::abs(motion_.height - height_of_root_) > kSameHeight) {
    height_of_root_ = motion_.height;
    const Length height = std::clamp(motion_.height, kLowest, kHighest);
    time_constant_s_ = fixed::square_root<Ratio>(fixed::product<Ratio>(height, fixed::kInverseGravity));
  }
  motion_.dcm = {motion_.position.x + fixed::product<Length>(motion_.velocity.x, time_constant_s_),
                 motion_.position.y + fixed::product<Length>(motion_.velocity.y, time_constant_s_)};
  return motion_;
}

}  // namespace koboshi::estimation
