#include "lab/trial/loop_gain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/text/user_units.h"

namespace koboshi::lab {
namespace {

// Where a quantity passes a level between two points, as a part of the way from the first.
double part_at(double first, double second, double level) { return (level - first) / (second - first); }

double between_logs(double first, double second, double part) {
  return std::exp(std::lerp(std::log(first), std::log(second), part));
}

}  // namespace

void SineCorrelator::add(double time_s, double value) {
  sum_ += value * std::polar(1.0, -2.0 * std::numbers::pi * frequency_Hz_ * time_s);
  ++count_;
}

std::complex<double> SineCorrelator::amplitude() const {
  return count_ == 0 ? std::complex<double>{} : 2.0 * sum_ / static_cast<double>(count_);
}

std::vector<double> unwrapped_phases_deg(std::span<const LoopPoint> points) {
  std::vector<double> phases;
  for (const LoopPoint& point : points) {
    double phase = kDegreesPerRad * std::arg(point.gain);
    const double near = phases.empty() ? -90.0 : phases.back();
    phase += 360.0 * std::round((near - phase) / 360.0);
    phases.push_back(phase);
  }
  return phases;
}

LoopMargins margins_of(std::span<const LoopPoint> points) {
  LoopMargins margins{.distance = std::numeric_limits<double>::infinity()};
  const std::vector<double> phases = unwrapped_phases_deg(points);
  for (const LoopPoint& point : points)
    margins.distance = std::min(margins.distance, std::abs(1.0 + point.gain));
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double before = std::abs(points[i - 1].gain);
    const double after = std::abs(points[i].gain);
    const auto frequency_at = [&](double part) {
      return between_logs(points[i - 1].frequency_Hz, points[i].frequency_Hz, part);
    };
    if (before >= 1.0 && after < 1.0) {
      const double part = part_at(std::log(before), std::log(after), 0.0);
      margins.crossover_Hz = frequency_at(part);
      margins.phase_margin_deg = std::remainder(180.0 + std::lerp(phases[i - 1], phases[i], part), 360.0);
    }
    // The first -180 degrees, or whole turns from there, at or below the phase before.
    const double level = 360.0 * std::floor((phases[i - 1] + 180.0) / 360.0) - 180.0;
    if (phases[i] < level) {
      const double part = part_at(phases[i - 1], phases[i], level);
      const double margin = 1.0 / between_logs(before, after, part);
      if (margins.gain_margin && *margins.gain_margin <= margin) continue;
      margins.phase_crossover_Hz = frequency_at(part);
      margins.gain_margin = margin;
    }
  }
  return margins;
}

}  // namespace koboshi::lab
