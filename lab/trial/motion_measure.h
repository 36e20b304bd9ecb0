#pragma once

#include <limits>
#include <optional>

#include "hal/port/side.h"
#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"

namespace koboshi::lab {

// Measures by the ground truth what a motion achieves.
class MotionMeasure {
 public:
  virtual ~MotionMeasure() = default;
  // Call it after each millisecond.
  virtual void observe(const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) = 0;
  // 0 if the motion achieved nothing.
  virtual double value() const = 0;
};

// The longest time, in s, that one foot was in the air without a break: its sole more than 5 mm above the
// ground, its load below 0.1 N, while the other foot carried the robot.
class OneLegTime final : public MotionMeasure {
 public:
  OneLegTime() = default;
  // Only this foot counts.
  explicit OneLegTime(hal::Side lifted) : only_(static_cast<int>(lifted)) {}

  void observe(const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) override;
  double value() const override { return longest_s_; }

 private:
  const std::optional<int> only_;
  double since_s_ = 0.0;
  int lifted_ = -1;
  double longest_s_ = 0.0;
};

// The horizontal speed of the first free body, in m/s, 0.2 s after the robot has left it; of several touches
// that of the fastest. A robot that follows its ball has not kicked it.
class BallSpeed final : public MotionMeasure {
 public:
  void observe(const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) override;
  double value() const override { return speed_m_per_s_; }
  // When the robot last touched the body; nothing if it missed the body.
  std::optional<double> touched_s() const { return touched_s_; }

 private:
  std::optional<double> touched_s_;
  bool is_free_ = false;  // longer than 0.2 s
  double speed_m_per_s_ = 0.0;
};

// How often the trunk rose by 20 mm while only the last links of arms, legs and neck touched the ground.
// Before it counts again, the trunk sinks by as much.
class PushUps final : public MotionMeasure {
 public:
  void observe(const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) override;
  double value() const override { return count_; }

 private:
  bool is_up_ = false;
  double turn_m_ = std::numeric_limits<double>::infinity();  // the lowest height, or the highest while up
  int count_ = 0;
};

}  // namespace koboshi::lab
