#include "sim_board/drive/position_demand.h"

#include <algorithm>
#include <cmath>

#include "sim_board/servo/position_unit.h"

namespace koboshi::sim_board {

void PositionDemand::hold(std::int32_t position) {
  *this = {};
  start_ = end_ = target_ = position;
}

void PositionDemand::approach(std::int32_t target, std::uint64_t now_us, std::uint32_t period_us) {
  start_ = position_at(now_us);
  end_ = target;
  start_us_ = now_us;
  end_us_ = start_ == end_ ? now_us : now_us + period_us;  // asked to stay, it stands at once
  speed_ = period_us == 0 ? 0.0 : (end_ - start_) / (1e-6 * period_us);
  deceleration_ = 0.0;
  end_speed_ = speed_;
  wait_us_ = period_us;
  target_ = end_;
  steepened_ = false;
  stop_by_us_.reset();
  profile_.reset();
}

bool PositionDemand::follow(std::int32_t target, std::uint64_t now_us, std::uint32_t period_us,
                            const CyclicLimits& limits) {
  const double period_s = 1e-6 * period_us;
  const double way = target - position_at(now_us);
  const double speed = way / period_s;
  const double step = target - target_;
  const double targets_speed = step / period_s;
  target_ = target;
  const double before = stream_speed(now_us);
  const double gained = std::abs(speed) - (speed * before > 0.0 ? std::abs(before) : 0.0);
  const double change = limits.motion.acceleration_units_per_s2 * period_s;
  const double first_step = limits.jump.velocity_units_per_s * period_s;
  jumps_ = (jumps_ || joins_ || std::abs(step) > limits.step_units) &&
           std::abs(way) > (joins_ ? std::min(first_step, limits.step_units) : limits.step_units);
  const bool on_its_way = profile_ && end_ == target && !stands(now_us);
  if (!jumps_ && !on_its_way && std::abs(speed) <= limits.motion.velocity_units_per_s && gained <= change &&
      std::abs(targets_speed - speed) <= change) {
    approach(target, now_us, period_us);
    joins_ = false;
    return true;
  }
  if (!on_its_way) move(target, now_us, jumps_ ? limits.jump : limits.motion, limits.range);
  return false;
}

void PositionDemand::stop(std::uint64_t now_us, double deceleration_units_per_s2, const PositionRange& range,
                          double highest_units_per_s) {
  const double speed = std::clamp(stream_speed(now_us), -highest_units_per_s, highest_units_per_s);
  start_ = position_at(now_us);
  if (!stop_by_us_ || stands(now_us)) stop_by_us_ = now_us + kMaxStopDuration_us;
  const double left_s = 1e-6 * static_cast<double>(*stop_by_us_ - std::min(now_us, *stop_by_us_ - 1));
  const double least = speed == 0.0 ? kAtOnce : least_deceleration(speed, start_, range, left_s);
  const double deceleration = std::max(deceleration_units_per_s2, least);
  steepened_ = deceleration > deceleration_units_per_s2;
  start_us_ = now_us;
  speed_ = speed;
  deceleration_ = std::copysign(deceleration, speed);
  const double time_s = std::abs(speed) / deceleration;
  end_ = start_ + 0.5 * speed * time_s;
  end_us_ = now_us + static_cast<std::uint64_t>(std::ceil(1e6 * time_s));
  end_speed_ = 0.0;
  profile_.reset();
}

void PositionDemand::continue_from(double position_units, double speed_units_per_s, std::uint64_t now_us) {
  // Long enough not to end before the stop, at the same instant.
  constexpr std::uint64_t kUntilStop_us = 1'000;
  if (stands(now_us)) stop_by_us_.reset();
  start_ = position_units;
  speed_ = speed_units_per_s;
  deceleration_ = 0.0;
  start_us_ = now_us;
  end_us_ = now_us + kUntilStop_us;
  end_ = start_ + 1e-6 * kUntilStop_us * speed_;
  profile_.reset();
}

void PositionDemand::move(std::int32_t target, std::uint64_t now_us, const ProfileLimits& limits,
                          const PositionRange& range) {
  const double speed = stream_speed(now_us);
  start_ = position_at(now_us);
  start_us_ = now_us;
  end_ = target;
  end_speed_ = 0.0;
  const double braking = speed == 0.0 ? 0.0 : least_deceleration(speed, start_, range);
  profile_.emplace(end_ - start_, speed, limits, braking);
  steepened_ = braking > limits.deceleration_units_per_s2;
  stop_by_us_.reset();
  end_us_ = now_us + static_cast<std::uint64_t>(std::ceil(1e6 * profile_->duration_s()));
}

std::int32_t PositionDemand::at(std::uint64_t now_us) const {
  return static_cast<std::int32_t>(nearest(position_at(now_us)));
}

double PositionDemand::position_at(std::uint64_t now_us) const {
  if (now_us >= end_us_) return end_;
  const double t = 1e-6 * static_cast<double>(now_us - start_us_);
  if (profile_) return start_ + profile_->distance_units(t);
  return start_ + speed_ * t - 0.5 * deceleration_ * t * t;
}

double PositionDemand::speed_units_per_s(std::uint64_t now_us) const {
  if (now_us >= end_us_) return 0.0;
  const double t = 1e-6 * static_cast<double>(now_us - start_us_);
  return profile_ ? profile_->speed_units_per_s(t) : speed_ - deceleration_ * t;
}

double PositionDemand::stream_speed(std::uint64_t now_us) const {
  if (now_us < end_us_) return speed_units_per_s(now_us);
  return now_us - end_us_ < wait_us_ ? end_speed_ : 0.0;
}

}  // namespace koboshi::sim_board
