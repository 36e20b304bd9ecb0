#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace koboshi::tools {

inline constexpr double kTick_s = 0.01;

// A step of a motion, as findings name it.
struct StepPlace {
  int line = 0;        // in the motion's file; 0: unknown
  int column = 0;      // 0: unknown
  std::string text{};  // such as "move to bow"
};

// The correction that a mix adds to a joint at its bound, while the deviation that its source measures is
// positive; the opposite one while it is negative.
struct MixBound {
  std::uint8_t joint = 0;
  std::uint8_t source = 0;  // motion::MixSource
  double bound_rad = 0.0;

  bool operator==(const MixBound&) const = default;
};
using MixBounds = std::vector<MixBound>;

// One path through a motion, sampled every 10 ms as the firmware plays it: the targets at the end of each
// tick and the step that is then played. It knows nothing of the language in which the motion was written.
struct Trajectory {
  std::size_t joints = 0;
  std::vector<double> targets_rad{};   // tick by tick; the first row is the pose before the motion
  std::vector<std::uint16_t> steps{};  // by tick
  // By tick: whether the motion counts on the robot's soles. A motion that expects a lying robot is not
  // judged for balance until it expects an upright one.
  std::vector<bool> on_feet{};
  // By tick: the declared lean in rad, forward and to the right.
  std::vector<double> lean_pitch_rad{};
  std::vector<double> lean_roll_rad{};
  // The mixes in force, without corrections that fade: by tick an index of `mix_bounds`, whose first element
  // is empty.
  std::vector<std::uint32_t> mixes{};
  std::vector<MixBounds> mix_bounds{{}};
  // The gains of the position loops, as shares of their own: by tick an index of `gain_sets`, by joint. The
  // first set is empty: all have their own.
  std::vector<std::uint32_t> gains{};
  std::vector<std::vector<double>> gain_sets{{}};
  // A joint whose corrections of kMix may turn it beyond one of its limits, where the firmware clamps it.
  struct Clamp {
    std::size_t tick = 0;     // the first one
    double excess_rad = 0.0;  // the most, on the whole path
  };
  std::map<std::size_t, Clamp> clamps{};  // by joint
  // How the path differs from the one before it from which it branches off: the outcome of this condition.
  // Empty: the first path, that of neutral sensors.
  struct Outcome {
    std::uint16_t step = 0;
    bool holds = false;
  };
  std::optional<Outcome> outcome{};
  std::size_t first_own_tick = 0;   // the ticks before it are those of an earlier path
  bool failed = false;              // the motion ends as failed
  bool merged = false;              // the path ends where an earlier one was in the same pose
  bool cut = false;                 // the motion goes on after the end of the path (kMaxPathTicks)
  std::size_t stop_tick = 0;        // of the stop command (kStopTick); 0: none
  std::vector<std::size_t> late{};  // ticks after which steps are left that belong into them
  std::string path{};               // `outcome` in words

  std::size_t ticks() const { return steps.size(); }
  std::span<const double> row(std::size_t tick) const {
    return std::span(targets_rad).subspan(tick * joints, joints);
  }
  const MixBounds& bounds_at(std::size_t tick) const { return mix_bounds[mixes[tick]]; }
  double gain(std::size_t tick, std::size_t joint) const {
    return gains[tick] == 0 ? 1.0 : gain_sets[gains[tick]][joint];
  }
  // Adds a tick without mixes, and with the drives' own gains.
  void add(std::span<const double> row_rad, std::uint16_t step, bool feet = true, double pitch_rad = 0.0,
           double roll_rad = 0.0) {
    joints = row_rad.size();
    targets_rad.insert(targets_rad.end(), row_rad.begin(), row_rad.end());
    steps.push_back(step);
    on_feet.push_back(feet);
    lean_pitch_rad.push_back(pitch_rad);
    lean_roll_rad.push_back(roll_rad);
    mixes.push_back(0);
    gains.push_back(0);
  }
  // Return the index of these mixes in `mix_bounds`, or of these gains in `gain_sets`, and add new ones.
  std::uint32_t index_of(const MixBounds& bounds) { return index_in(mix_bounds, bounds); }
  std::uint32_t index_of(const std::vector<double>& gain_set) { return index_in(gain_sets, gain_set); }

 private:
  template <typename Value>
  static std::uint32_t index_in(std::vector<Value>& values, const Value& value) {
    const auto place = std::ranges::find(values, value);
    const auto index = static_cast<std::uint32_t>(place - values.begin());
    if (place == values.end()) values.push_back(value);
    return index;
  }
};

}  // namespace koboshi::tools
