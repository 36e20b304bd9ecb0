#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "hal/port/side.h"
#include "simulation/gait/gait.h"
#include "simulation/gait/pendulum.h"

namespace koboshi::simulation {

// What a walk intends at one instant. W lies on level ground in the middle between the feet of the robot that
// stands before the walk, x ahead.
struct GaitInstant {
  Eigen::Vector2d com_W_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d zmp_W_m = Eigen::Vector2d::Zero();
  std::array<Eigen::Isometry3d, 2> X_WSole{Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()};
  std::array<double, 2> load_share{};                 // of the weight on each foot, by hal::Side
  hal::Side support = hal::Side::kLeft;               // the foot with more of the load
  Eigen::Vector2d zmp_S_m = Eigen::Vector2d::Zero();  // in the sole frame of the support
};

// The pattern of a walk straight ahead by the linear inverted pendulum: from standing, with growing steps,
// into a cycle of two steps that repeats for ever, and with shrinking steps back to standing.
//
// The ZMP rests in one foot during single support and goes to the other at constant speed during double
// support. Feet and ZMP are given; the mass follows by the closed form. In the cycle it moves on the one
// periodic orbit. It gets there from rest, and back to rest, because the ZMP leaves its place a little in two
// stages: before the first step and in the last before the cycle, in the first behind the cycle and after the
// last step (two unknowns an axis, two conditions).
class GaitPlan {
 public:
  explicit GaitPlan(const Gait& gait);

  // `time_s` counts from the beginning of the walk; before it the robot stands. The cycle repeats until the
  // end of time.
  GaitInstant at(double time_s) const;
  // `time_s` counts from the end of a cycle.
  GaitInstant at_stop(double time_s) const;

  double start_s() const { return duration_s(start_); }
  double cycle_s() const { return duration_s(cycle_); }
  double stop_s() const { return duration_s(stop_); }
  // How far the robot gets in a cycle.
  double stride_m() const { return 2.0 * gait_.step_length_m; }

 private:
  using Soles = std::array<Eigen::Vector2d, 2>;  // by Side

  // A stretch of time between two moments in the middle of double support.
  struct Stage {
    Soles soles;  // at its beginning
    std::optional<hal::Side> swing;
    Eigen::Vector2d landing = Eigen::Vector2d::Zero();  // of the sole that swings
    std::array<ZmpPiece, 3> zmp;
    PendulumState begin;

    double duration_s() const;
    // What lies between the ends, parallel to itself.
    void move_zmp(const Eigen::Vector2d& by);
  };

  static double duration_s(const std::vector<Stage>& stages);
  Eigen::Vector2d zmp_of(hal::Side side, const Eigen::Vector2d& sole) const;
  Eigen::Vector2d middle_zmp(const Soles& soles) const;
  Stage shift(const Soles& soles) const;
  Stage step(const Soles& soles, hal::Side swing, double length_m) const;
  Soles add_steps(std::vector<Stage>& stages, Soles soles, hal::Side swing,
                  const std::vector<double>& shares) const;
  void plan();
  PendulumState periodic_state() const;
  PendulumState pass(const Stage& stage, const PendulumState& begin) const;
  PendulumState pass(const std::vector<Stage>& stages, PendulumState state) const;
  void enter(std::vector<Stage>& stages, PendulumState state) const;
  void aim(std::vector<Stage>& stages, const std::array<Stage*, 2>& movable, const PendulumState& begin,
           const PendulumState& end) const;
  GaitInstant instant(const std::vector<Stage>& stages, double time_s) const;

  Gait gait_;
  Pendulum pendulum_;
  std::vector<Stage> start_;
  std::vector<Stage> cycle_;
  std::vector<Stage> stop_;
};

}  // namespace koboshi::simulation
