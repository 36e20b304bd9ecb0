#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "simulation/record/summary.h"
#include "simulation/scenario/scenario.h"
#include "studio/run/session.h"
#include "view/recording/recording.h"

namespace koboshi::studio {

// Two simulations that differ in their parameters and get the same seed and the same inputs at the same
// simulated times. Each has a thread of its own and gives the same bits as it does alone.
class Comparison {
 public:
  static constexpr std::size_t kRuns = 2;  // A and B

  // The scenarios differ in their parameters only: the second one takes the seed of the first. Throws what
  // simulation::Simulation throws.
  explicit Comparison(std::array<simulation::Scenario, kRuns> scenarios);

  // Lets both advance, at most to the end of the scenario. Returns at once.
  void advance(std::uint64_t milliseconds);
  // Gives both an input, at the time up to which they are to advance.
  void give(const Input& input);
  // Whether a simulation is still on its way there.
  [[nodiscard]] bool is_busy() const;
  [[nodiscard]] bool is_finished() const { return target_us_ >= duration_us_; }
  // Returns once both have arrived.
  void wait();
  // Error that stopped a simulation, one line; empty: none.
  [[nodiscard]] std::string error() const;

  // Appends what the simulations have recorded since. Returns whether there was anything.
  bool take();
  const view::Recording& recording(std::size_t run) const { return runs_.at(run).recording; }
  // Number of samples that both have.
  [[nodiscard]] std::size_t common_samples() const;
  [[nodiscard]] SessionStatus status(std::size_t run) const { return runs_.at(run).session->status(); }
  // Waits for the simulation. Results so far.
  [[nodiscard]] simulation::RunSummary summary(std::size_t run) { return runs_.at(run).session->summary(); }
  [[nodiscard]] std::uint64_t state_hash(std::size_t run) { return runs_.at(run).session->state_hash(); }

 private:
  struct Run {
    std::unique_ptr<Session> session;
    view::Recording recording;
  };

  std::array<Run, kRuns> runs_;
  std::uint64_t duration_us_;
  std::uint64_t target_us_ = 0;
};

// A result of both runs. NaN: not measured.
struct ComparedResult {
  std::string name;  // "Speed"
  std::string unit;
  int decimals = 0;
  std::array<double, Comparison::kRuns> values{};

  double difference() const { return values[1] - values[0]; }
};

// Speed, drift, ZMP and falls of two runs.
[[nodiscard]] std::vector<ComparedResult> compare(const simulation::RunSummary& a,
                                                  const simulation::RunSummary& b);

// A quantity over time, of the trunk in the world: lengths along and across the heading at the start.
enum class TrunkQuantity { kSpeed, kDistance, kDrift, kLean };
// At a sample: the mean speed of the second before in m/s, distance and drift to the left in m, lean in rad.
[[nodiscard]] double trunk_quantity(const view::Recording& recording, std::size_t sample,
                                    TrunkQuantity quantity);

// The scene of both robots, with the second one's links behind those of the first, tinted in the colours of
// the runs.
[[nodiscard]] view::Scene scene_of_both(const view::Scene& a, const view::Scene& b,
                                        const std::array<view::Colour, Comparison::kRuns>& colours);
// The poses in this scene, the robots apart by `apart_m` across the x axis of the world, A to the left.
[[nodiscard]] std::vector<view::Pose> poses_of_both(const std::vector<view::Pose>& a,
                                                    const std::vector<view::Pose>& b, double apart_m);

}  // namespace koboshi::studio
