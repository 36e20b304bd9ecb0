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

// Reference state of a walk at one instant. W lies on level ground, midway between the feet of the robot
// before it walks, with x forward.
struct GaitInstant {
  Eigen::Vector2d com_W_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d zmp_W_m = Eigen::Vector2d::Zero();
  std::array<Eigen::Isometry3d, 2> X_WSole{Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()};
  std::array<double, 2> load_share{};                 // share of the weight on each foot, by hal::Side
  hal::Side support = hal::Side::kLeft;               // the foot with more load
  Eigen::Vector2d zmp_S_m = Eigen::Vector2d::Zero();  // in the sole frame of the support foot
};

// Plan of a straight walk by the linear inverted pendulum: from standing, with growing steps, into a periodic
// cycle of two steps, and with shrinking steps back to standing.
//
// During single support the ZMP is fixed in the support foot; during double support it moves to the other
// foot at constant speed. Feet and ZMP are given; the motion of the centre of mass follows in closed form. In
// the cycle the mass is on the unique periodic orbit. To reach this orbit from rest, and to come to rest
// again, the ZMP deviates in two stages each: at the start in the first stage and in the last before the
// cycle, at the stop in the first stage after the cycle and in the last. Two unknowns per axis satisfy the
// two conditions.
class GaitPlan {
 public:
  explicit GaitPlan(const Gait& gait);

  // Reference state at `time_s` after the beginning of the walk. Before it the robot stands; afterwards the
  // cycle repeats without end.
  GaitInstant at(double time_s) const;
  // Reference state at `time_s` after the end of the last cycle.
  GaitInstant at_stop(double time_s) const;

  double start_s() const { return duration_s(start_); }
  double cycle_s() const { return duration_s(cycle_); }
  double stop_s() const { return duration_s(stop_); }
  // Distance per cycle.
  double stride_m() const { return 2.0 * gait_.step_length_m; }

 private:
  using Soles = std::array<Eigen::Vector2d, 2>;  // by Side

  // An interval between two midpoints of double support.
  struct Stage {
    Soles soles;  // at its beginning
    std::optional<hal::Side> swing;
    Eigen::Vector2d landing = Eigen::Vector2d::Zero();  // of the swing sole
    std::array<ZmpPiece, 3> zmp;
    PendulumState begin;

    double duration_s() const;
    // Shifts the ZMP between the ends, parallel to itself.
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
