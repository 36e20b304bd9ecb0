#include "sim_board/engine/mujoco/lift_iteration.h"

#include <algorithm>
#include <cmath>

namespace koboshi::sim_board {
namespace {

// Bounds of the relaxation factor: slopes F' from -49 to 0.9 converge within them. When a contact changes
// between sticking, sliding and separation, the secant is meaningless.
constexpr double kMinOmega = 0.02;
constexpr double kMaxOmega = 10.0;

}  // namespace

LiftIteration::LiftIteration(std::size_t max_contacts)
    : lifts_(max_contacts), residuals_(max_contacts), last_residuals_(max_contacts) {}

void LiftIteration::begin(std::span<const double> lifts_m_per_s) {
  count_ = lifts_m_per_s.size();
  solutions_ = 0;
  omega_ = 1.0;
  settled_ = true;
  std::ranges::copy(lifts_m_per_s, lifts_.begin());
}

bool LiftIteration::is_over(std::span<const double> slips_m_per_s) {
  ++solutions_;
  settled_ = true;
  bool sinks = false;
  for (std::size_t i = 0; i < count_; ++i) {
    residuals_[i] = slips_m_per_s[i] - lifts_[i];
    settled_ = settled_ && std::abs(residuals_[i]) <= kTolerance_m_per_s;
    sinks = sinks || residuals_[i] < -kTolerance_m_per_s;
  }
  if (settled_ || solutions_ == kMaxSolutions) return true;
  if (solutions_ < kAitkenSolutions) {
    relax();
    return false;
  }
  lower();
  return !sinks;
}

void LiftIteration::relax() {
  if (solutions_ > 1) {
    double product = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double change = residuals_[i] - last_residuals_[i];
      product += last_residuals_[i] * change;
      square += change * change;
    }
    if (square > 0.0) omega_ = std::clamp(-omega_ * product / square, kMinOmega, kMaxOmega);
  }
  for (std::size_t i = 0; i < count_; ++i) lifts_[i] = std::max(0.0, lifts_[i] + omega_ * residuals_[i]);
  std::swap(residuals_, last_residuals_);
}

void LiftIteration::lower() {
  for (std::size_t i = 0; i < count_; ++i)
    if (residuals_[i] < -kTolerance_m_per_s) lifts_[i] += residuals_[i];
}

}  // namespace koboshi::sim_board
