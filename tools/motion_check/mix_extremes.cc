#include "tools/motion_check/mix_extremes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "tools/motion_check/hash.h"

namespace koboshi::tools {
namespace {

std::uint8_t sources_of(const MixBounds& bounds) {
  unsigned sources = 0;
  for (const MixBound& bound : bounds) sources |= 1U << bound.source;
  return static_cast<std::uint8_t>(sources);
}

std::uint64_t hash_of(const MixBounds& bounds) {
  std::uint64_t hash = kHashSeed;
  for (const MixBound& bound : bounds) {
    add_to_hash(hash, bound.joint | std::uint64_t{bound.source} << 8);
    add_to_hash(hash, std::bit_cast<std::uint64_t>(bound.bound_rad));
  }
  return hash;
}

// The ticks of a path that are evaluated: those in which a step or its mixes end, and those in which a joint
// has moved by `spacing_rad` since the last one.
std::vector<std::size_t> ticks_to_evaluate(const Trajectory& trajectory, double spacing_rad) {
  std::vector<std::size_t> ticks;
  const std::size_t count = trajectory.ticks();
  std::span<const double> last;
  for (std::size_t tick = 0; tick < count; ++tick) {
    if (trajectory.mixes[tick] == 0) {
      last = {};
      continue;
    }
    const auto row = trajectory.row(tick);
    const bool ends = tick + 1 == count || trajectory.steps[tick + 1] != trajectory.steps[tick] ||
                      trajectory.mixes[tick + 1] != trajectory.mixes[tick];
    bool moved = last.empty();
    for (std::size_t j = 0; j < row.size() && !ends && !moved; ++j)
      moved = std::abs(row[j] - last[j]) >= spacing_rad;
    if (!ends && !moved) continue;
    ticks.push_back(tick);
    last = row;
  }
  return ticks;
}

// Keeps ticks evenly, so that they have at most so many extremes together.
void thin_out(std::vector<std::size_t>& ticks, const Trajectory& trajectory, std::size_t max_extremes) {
  std::size_t extremes = 0;
  for (const std::size_t tick : ticks)
    extremes += std::size_t{1} << std::popcount(sources_of(trajectory.bounds_at(tick)));
  const std::size_t every = (extremes + max_extremes - 1) / max_extremes;
  if (every <= 1) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < ticks.size(); i += every) ticks[kept++] = ticks[i];
  ticks.resize(kept);
}

}  // namespace

// Sets `angles_` to the targets with the corrections at their bounds, within the joints' limits.
void MixExtremes::apply(std::span<const double> targets_rad, const MixBounds& bounds, std::uint8_t signs) {
  angles_.assign(targets_rad.begin(), targets_rad.end());
  for (const MixBound& bound : bounds) {
    const bool positive = (signs >> bound.source & 1U) != 0;
    const sim_board::JointDescription& joint = robot_.joints[bound.joint];
    double& angle_rad = angles_[bound.joint];
    angle_rad = std::clamp(angle_rad + (positive ? bound.bound_rad : -bound.bound_rad), joint.lower_rad,
                           joint.upper_rad);
  }
}

MixExtreme MixExtremes::worst_of(const Trajectory& trajectory, std::size_t tick) {
  const MixBounds& bounds = trajectory.bounds_at(tick);
  const unsigned sources = sources_of(bounds);
  MixExtreme worst{.tick = tick, .sources = static_cast<std::uint8_t>(sources)};
  worst.com.distance_m = std::numeric_limits<double>::infinity();
  // All subsets of the sources.
  for (unsigned signs = sources;; signs = (signs - 1) & sources) {
    const auto mask = static_cast<std::uint8_t>(signs);
    apply(trajectory.row(tick), bounds, mask);
    body_.place(angles_, X_BLs_);
    if (const Overlap overlap = pairs_.deepest(X_BLs_); overlap.depth_m > worst.overlap.depth_m) {
      worst.overlap = overlap;
      worst.overlap_signs = mask;
    }
    if (trajectory.on_feet[tick]) {
      // The servos yield to the load, as in MotionAnalysis.
      body_.solve_at_rest(angles_, stance_);
      for (std::size_t j = 0; j < angles_.size(); ++j)
        angles_[j] -= stance_.torques_Nm[j] / (stiffness_Nm_[j] * trajectory.gain(tick, j));
      body_.solve_at_rest(angles_, stance_);
      const Margin com = margin_in(body_.support_polygon(stance_), stance_.com_m);
      if (com.distance_m < worst.com.distance_m) {
        worst.com = com;
        worst.com_signs = mask;
      }
    }
    if (signs == 0) return worst;
  }
}

std::vector<MixExtreme> MixExtremes::evaluate(const Trajectory& trajectory,
                                              std::span<const std::uint64_t> keys,
                                              const std::stop_token& cancel) {
  std::vector<MixExtreme> extremes;
  if (trajectory.mix_bounds.size() <= 1) return extremes;
  std::vector<std::uint64_t> hashes;
  for (const MixBounds& bounds : trajectory.mix_bounds) hashes.push_back(hash_of(bounds));
  std::vector<std::size_t> ticks = ticks_to_evaluate(trajectory, kSpacing_rad);
  thin_out(ticks, trajectory, kMaxExtremes);
  for (const std::size_t tick : ticks) {
    if (cancel.stop_requested()) break;
    std::uint64_t key = keys[tick];
    add_to_hash(key, hashes[trajectory.mixes[tick]]);
    const auto [known, is_new] = known_.try_emplace(key);
    if (is_new) known->second.extreme = worst_of(trajectory, tick);
    known->second.used = time_;
    extremes.push_back(known->second.extreme);
    const bool begins = tick == 0 || trajectory.mixes[tick - 1] != trajectory.mixes[tick];
    extremes.back().tick = begins && tick + 1 < trajectory.ticks() ? tick + 1 : tick;
  }
  return extremes;
}

void MixExtremes::forget_unused() {
  std::erase_if(known_, [&](const auto& known) { return known.second.used < time_; });
  ++time_;
}

}  // namespace koboshi::tools
