#include "sim_board/servo/position_demand.h"

#include <cmath>

namespace koboshi::sim {

void PositionDemand::hold(std::int32_t position) {
  *this = {};
  start_ = end_ = position;
}

void PositionDemand::approach(std::int32_t target, std::uint64_t now_us, std::uint32_t period_us) {
  start_ = position_at(now_us);
  end_ = target;
  start_us_ = now_us;
  end_us_ = start_ == end_ ? now_us : now_us + period_us;  // asked to stay, it stands at once
  speed_ = period_us == 0 ? 0.0 : (end_ - start_) / (1e-6 * period_us);
  deceleration_ = 0.0;
  end_speed_ = speed_;
  profile_.reset();
}

void PositionDemand::stop(std::uint64_t now_us, double deceleration_units_per_s2) {
  const double speed = speed_units_per_s(now_us);
  start_ = position_at(now_us);
  start_us_ = now_us;
  speed_ = speed;
  deceleration_ = std::copysign(deceleration_units_per_s2, speed);
  const double time_s = std::abs(speed) / deceleration_units_per_s2;
  end_ = start_ + 0.5 * speed * time_s;
  end_us_ = now_us + static_cast<std::uint64_t>(std::ceil(1e6 * time_s));
  end_speed_ = 0.0;
  profile_.reset();
}

void PositionDemand::move(std::int32_t target, std::uint64_t now_us, const ProfileLimits& limits) {
  const double speed = speed_units_per_s(now_us);
  start_ = position_at(now_us);
  start_us_ = now_us;
  end_ = target;
  end_speed_ = 0.0;
  profile_.emplace(end_ - start_, speed, limits);
  end_us_ = now_us + static_cast<std::uint64_t>(std::ceil(1e6 * profile_->duration_s()));
}

std::int32_t PositionDemand::at(std::uint64_t now_us) const {
  return static_cast<std::int32_t>(std::lround(position_at(now_us)));
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

}  // namespace koboshi::sim
