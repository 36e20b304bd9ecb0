#include "sim_board/drive/motion_profile.h"

#include <algorithm>
#include <cmath>

namespace koboshi::sim_board {

MotionProfile::MotionProfile(double distance_units, double speed_units_per_s, const ProfileLimits& limits,
                             double braking_units_per_s2)
    : speed_units_per_s_(speed_units_per_s) {
  const double acceleration = limits.acceleration_units_per_s2;
  const double deceleration = limits.deceleration_units_per_s2;
  const double braking_units = 0.5 * speed_units_per_s * std::abs(speed_units_per_s) / deceleration;
  const bool away = speed_units_per_s * (distance_units - braking_units) < 0.0;
  if (away) change_speed(0.0, std::max(deceleration, braking_units_per_s2));
  const double way_units = distance_units - position_units_;
  const double start = std::abs(speed_units_per_s_);
  // v^2 of the triangle: (v^2 - start^2) / 2a + v^2 / 2d = way.
  const double peak_squared =
      (std::abs(way_units) + 0.5 * start * start / acceleration) / (0.5 / acceleration + 0.5 / deceleration);
  const double top = std::min(std::sqrt(peak_squared), limits.velocity_units_per_s);
  const double before_units = position_units_;
  change_speed(std::copysign(top, way_units), top < start ? deceleration : acceleration);
  const double last_units = std::copysign(0.5 * top * top / deceleration, way_units);
  cruise(way_units - (position_units_ - before_units) - last_units);
  change_speed(0.0, deceleration);
}

void MotionProfile::change_speed(double speed_units_per_s, double acceleration_units_per_s2) {
  const double change = speed_units_per_s - speed_units_per_s_;
  Phase& phase = phases_[count_++];
  phase = {.duration_s = std::abs(change) / acceleration_units_per_s2,
           .start_units = position_units_,
           .speed_units_per_s = speed_units_per_s_,
           .acceleration_units_per_s2 = std::copysign(acceleration_units_per_s2, change)};
  position_units_ += 0.5 * (speed_units_per_s + speed_units_per_s_) * phase.duration_s;
  speed_units_per_s_ = speed_units_per_s;
}

void MotionProfile::cruise(double distance_units) {
  const double time_s = speed_units_per_s_ == 0.0 ? 0.0 : distance_units / speed_units_per_s_;
  Phase& phase = phases_[count_++];
  // A triangle leaves nothing but a rounding error, of either sign.
  phase = {.duration_s = std::max(time_s, 0.0),
           .start_units = position_units_,
           .speed_units_per_s = speed_units_per_s_};
  position_units_ += distance_units;
}

double MotionProfile::duration_s() const {
  double total_s = 0.0;
  for (std::size_t i = 0; i < count_; ++i) total_s += phases_[i].duration_s;
  return total_s;
}

const MotionProfile::Phase& MotionProfile::phase_at(double& t_s) const {
  std::size_t i = 0;
  for (; i + 1 < count_ && t_s >= phases_[i].duration_s; ++i) t_s -= phases_[i].duration_s;
  return phases_[i];
}

double MotionProfile::distance_units(double t_s) const {
  const Phase& phase = phase_at(t_s);
  return phase.start_units + (phase.speed_units_per_s + 0.5 * phase.acceleration_units_per_s2 * t_s) * t_s;
}

double MotionProfile::speed_units_per_s(double t_s) const {
  const Phase& phase = phase_at(t_s);
  return phase.speed_units_per_s + phase.acceleration_units_per_s2 * t_s;
}

}  // namespace koboshi::sim_board
