#include "firmware/motion/trajectory.h"

#include <algorithm>
#include <bit>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/interpolation.h"

namespace koboshi::motion {

using fixed::Angle;
using fixed::Ratio;
using robot::clamp_to_limits;

namespace {

constexpr int kOneBits = Ratio::kFractionBits;

// Calls `visit` for each joint of a mask, the lowest first.
template <typename Visit>
void for_each(std::uint32_t joints, Visit visit) {
  for (; joints != 0; joints &= joints - 1) visit(static_cast<std::size_t>(std::countr_zero(joints)));
}

constexpr std::int64_t product_raw(std::int64_t a, std::int64_t b) { return a * b >> kOneBits; }

// How far two angles are apart, as numbers: less than one turn.
constexpr std::uint32_t distance(Angle a, Angle b) {
  const auto raw = [](Angle angle) { return static_cast<std::uint32_t>(angle.raw()); };
  return a.raw() > b.raw() ? raw(a) - raw(b) : raw(b) - raw(a);
}

// 10 s^3 - 15 s^4 + 6 s^5.
Ratio minimum_jerk(Ratio fraction) {
  const std::int64_t s = fraction.raw();
  const std::int64_t s2 = product_raw(s, s);
  const std::int64_t s3 = product_raw(s2, s);
  return Ratio::from_raw(
      static_cast<std::int32_t>(product_raw(s3, (std::int64_t{10} << kOneBits) - 15 * s + 6 * s2)));
}

// The share of the way after this share of the time, with a third of it each to speed up and to slow down.
Ratio trapezoid(Ratio fraction) {
  constexpr std::int64_t kOne = std::int64_t{1} << kOneBits;
  const std::int64_t s = fraction.raw();
  const std::int64_t left = kOne - s;
  const std::int64_t way = 3 * s <= kOne      ? 9 * product_raw(s, s) / 4
                           : 3 * left <= kOne ? kOne - 9 * product_raw(left, left) / 4
                                              : 3 * s / 2 - kOne / 4;
  return Ratio::from_raw(static_cast<std::int32_t>(way));
}

// The weights of the harmonic mean, 2^-16, from the share w = T1 / (T1 + T2) of the present move's time.
struct Weights {
  std::uint32_t present = 0;  // w
  std::uint32_t next = 0;     // 1 - w
  std::uint32_t a = 0;        // of the next move's speed: (2 - w) / 3
  std::uint32_t b = 0;        // of the present one's: (1 + w) / 3

  Weights(std::uint32_t time_us, std::uint32_t next_time_us)
      : present(static_cast<std::uint32_t>((std::uint64_t{time_us} << 16) / (time_us + next_time_us))),
        next(0x10000 - present),
        a((0x20000 - present) / 3),
        b((0x10000 + present) / 3) {}
};

struct Slopes {
  std::int32_t end = 0;   // T1 v1
  std::int32_t next = 0;  // T2 v1
};

// Returns v1 times the durations of both moves, from their differences. With p = d1 T1 T2 / (T1 + T2), which
// is (p1 - p0) (1 - w), and q likewise of the next move, T1 v1 = (p1 - p0) q / (a q + b p): one quotient, of
// 2^-14, from numbers that are scaled to use their 32 bits. The denominator is rounded up, so that neither
// quotient exceeds 3.
Slopes slopes(std::int32_t present, std::int32_t next, const Weights& weights) {
  if (present == 0 || next == 0 || (present < 0) != (next < 0)) return {};
  std::uint32_t p = static_cast<std::uint32_t>(std::uint64_t{fixed::magnitude(present)} * weights.next >> 16);
  std::uint32_t q = static_cast<std::uint32_t>(std::uint64_t{fixed::magnitude(next)} * weights.present >> 16);
  const int spare = std::countl_zero(p | q);
  if (spare == 32) return {};
  p <<= spare;
  q <<= spare;
  const auto denominator =
      static_cast<std::uint32_t>((std::uint64_t{q} * weights.a + std::uint64_t{p} * weights.b) >> 30) + 1;
  const auto scaled = [denominator](std::int32_t difference, std::uint32_t numerator) {
    return static_cast<std::int32_t>(difference * std::int64_t{numerator / denominator} >> 14);
  };
  return {scaled(present, q), scaled(next, p)};
}

}  // namespace

Trajectory::Trajectory(const robot::RobotModel& model) : model_(model) {
  for (std::size_t i = 0; i < model_.joint_count; ++i)
    targets_[i] = clamp_to_limits(model_.joints[i], Angle());
  from_ = targets_;
  to_ = targets_;
}

void Trajectory::reset(std::span<const Angle> pose) {
  KOBOSHI_ASSERT(pose.size() == model_.joint_count);
  for (std::size_t i = 0; i < model_.joint_count; ++i)
    targets_[i] = clamp_to_limits(model_.joints[i], pose[i]);
  from_ = targets_;
  to_ = targets_;
  begin_wait();
}

void Trajectory::release(std::uint32_t joints, std::span<const Angle> angles) {
  moving_ &= ~joints;
  through_ &= ~joints;
  for_each(joints, [&](std::size_t joint) {
    if (joint >= angles.size()) return;
    const Angle measured = clamp_to_limits(model_.joints[joint], angles[joint]);
    targets_[joint] = from_[joint] = to_[joint] = measured;
  });
}

std::uint32_t Trajectory::duration_us(Interpolation interpolation, std::uint32_t travel,
                                      std::uint32_t speed) {
  KOBOSHI_ASSERT(speed > 0);
  // The ratio of peak to mean speed, in eighths: linear 1, minimum jerk 15/8, cubic from and to rest 3/2,
  // trapezoid 3/2.
  constexpr std::array<std::uint32_t, 4> kPeakRatio{8, 15, 12, 12};
  constexpr std::uint32_t kPerEighth = 1'000'000 / 8;
  constexpr int kShift = Angle::kFractionBits - fixed::AngularRate::kFractionBits;
  const std::uint64_t way =
      std::uint64_t{travel} * (kPerEighth * kPeakRatio[static_cast<std::size_t>(interpolation)]);
  const std::uint64_t divisor = std::uint64_t{speed} << kShift;
  const std::uint64_t time_us = (way + divisor - 1) / divisor;
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(time_us, kMinStepTime_us, kMaxStepTime_us));
}

std::uint32_t Trajectory::look_ahead(PoseReader pose) {
  joints_ahead_ = pose.joints();
  std::uint32_t travel = 0;
  std::uint32_t staying = 0;
  while (pose.joints() != 0) {
    std::size_t joint = 0;
    const Angle angle = pose.read(joint);
    ahead_[joint] = clamp_to_limits(model_.joints[joint], angle);
    const std::uint32_t way = distance(ahead_[joint], to_[joint]);
    travel = std::max(travel, way);
    if (way == 0) staying |= 1u << joint;
  }
  changing_ahead_ = joints_ahead_ & ~staying;
  return travel;
}

std::uint32_t Trajectory::fastest_us(Interpolation interpolation) const {
  // The joint that takes the longest, by products instead of a division for each joint.
  std::uint32_t travel = 0;
  std::uint32_t speed = 1;
  for_each(changing_ahead_, [&](std::size_t joint) {
    const std::uint32_t way = distance(ahead_[joint], to_[joint]);
    const auto limit = static_cast<std::uint32_t>(model_.joints[joint].max_speed.raw());
    if (std::uint64_t{way} * speed <= std::uint64_t{travel} * limit) return;
    travel = way;
    speed = limit;
  });
  return duration_us(interpolation, travel, speed);
}

void Trajectory::begin_wait() {
  moving_ = 0;
  through_ = 0;
  part_count_ = 0;
}

void Trajectory::begin_move(Interpolation interpolation, bool continues) {
  interpolation_ = interpolation;
  part_count_ = 0;
  const bool cubic = interpolation == Interpolation::kCubic;
  moving_ = cubic ? joints_ahead_ : changing_ahead_;
  const std::uint32_t in_motion = continues ? through_ : 0;
  through_ = 0;
  for_each(moving_, [&](std::size_t joint) {
    to_[joint] = ahead_[joint];
    if (!cubic) return;
    Tangents& tangents = tangents_[joint];
    tangents = {.start = (in_motion >> joint & 1u) != 0 ? tangents.next : 0};
  });
}

void Trajectory::add_window(const Window& window) {
  constexpr std::uint32_t kWhole = std::uint32_t{Window::kWhole} << 16;
  KOBOSHI_ASSERT(part_count_ < parts_.size() && window.start < window.end &&
                 interpolation_ != Interpolation::kCubic);
  const auto part = static_cast<std::uint32_t>(window.end - window.start);
  // Rounded up, so that the joints are at the pose at the end of the window.
  parts_[part_count_++] = {.joints = window.joints,
                           .start_raw = std::int32_t{window.start} << (kOneBits - Window::kBits),
                           .rate = (kWhole + part - 1) / part};
}

void Trajectory::plan_through(std::uint32_t time_us, std::uint32_t next_time_us) {
  KOBOSHI_ASSERT(interpolation_ == Interpolation::kCubic);
  const Weights weights(time_us, next_time_us);
  through_ = moving_ & joints_ahead_;
  for_each(through_, [&](std::size_t joint) {
    const std::int64_t way = std::int64_t{ahead_[joint].raw()} - to_[joint].raw();
    const Slopes found = slopes(static_cast<std::int32_t>(difference(joint) >> kTangentShift),
                                static_cast<std::int32_t>(way >> kTangentShift), weights);
    tangents_[joint].end = found.end;
    tangents_[joint].next = found.next;
  });
}

void Trajectory::interpolate(Ratio fraction) {
  if (interpolation_ == Interpolation::kCubic) return interpolate_cubic(fraction);
  std::uint32_t left = moving_;
  for (std::size_t i = 0; i < part_count_; ++i) {
    const Part& part = parts_[i];
    const std::int64_t elapsed_raw =
        std::max<std::int64_t>(fraction.raw() - part.start_raw, 0) * part.rate >> 16;
    const Ratio own = Ratio::from_raw(
        static_cast<std::int32_t>(std::min<std::int64_t>(elapsed_raw, std::int64_t{1} << kOneBits)));
    interpolate_profile(left & part.joints, own);
    left &= ~part.joints;
  }
  interpolate_profile(left, fraction);
}

void Trajectory::interpolate_profile(std::uint32_t joints, Ratio fraction) {
  if (joints == 0) return;
  switch (interpolation_) {
    case Interpolation::kMinimumJerk:
      return interpolate_linearly(joints, minimum_jerk(fraction));
    case Interpolation::kTrapezoid:
      return interpolate_linearly(joints, trapezoid(fraction));
    case Interpolation::kLinear:
    case Interpolation::kCubic:
      return interpolate_linearly(joints, fraction);
  }
}

void Trajectory::interpolate_linearly(std::uint32_t joints, Ratio fraction) {
  for_each(joints, [&](std::size_t joint) {
    targets_[joint] = fixed::interpolate(from_[joint], to_[joint], fraction);
  });
}

void Trajectory::interpolate_cubic(Ratio fraction) {
  const std::int64_t s = fraction.raw();
  const std::int64_t s2 = product_raw(s, s);
  const std::int64_t s3 = product_raw(s2, s);
  const auto way = static_cast<std::int32_t>(3 * s2 - 2 * s3);
  const auto start = static_cast<std::int32_t>(s3 - 2 * s2 + s);
  const auto end = static_cast<std::int32_t>(s3 - s2);
  for_each(moving_, [&](std::size_t joint) {
    const Tangents& tangents = tangents_[joint];
    const auto whole = static_cast<std::int32_t>(difference(joint) >> kTangentShift);
    const std::int64_t sum =
        std::int64_t{whole} * way + std::int64_t{tangents.start} * start + std::int64_t{tangents.end} * end;
    const std::int64_t target_raw = from_[joint].raw() + fixed::shift_rounded(sum, kOneBits - kTangentShift);
    const robot::Joint& limits = model_.joints[joint];
    targets_[joint] = Angle::from_raw(static_cast<std::int32_t>(
        std::clamp<std::int64_t>(target_raw, limits.lower.raw(), limits.upper.raw())));
  });
}

void Trajectory::finish() {
  for_each(moving_, [&](std::size_t joint) {
    from_[joint] = to_[joint];
    targets_[joint] = to_[joint];
  });
}

}  // namespace koboshi::motion
