#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace koboshi::sim_board {

// Magnitudes, in units of the bus (2^-20 turn) and seconds; all above 0.
struct ProfileLimits {
  double velocity_units_per_s = 0.0;       // 0x6081
  double acceleration_units_per_s2 = 0.0;  // 0x6083
  double deceleration_units_per_s2 = 0.0;  // 0x6084

  friend bool operator==(const ProfileLimits&, const ProfileLimits&) = default;
};

// The trapezoidal velocity profile of CiA 402-2 (linear ramps): from any speed over a distance to rest there,
// in at most four phases of constant acceleration. A move that would overshoot, or that starts in the wrong
// direction, brakes to rest first; too short a way for the profile velocity makes a triangle.
class MotionProfile {
 public:
  // `braking_units_per_s2`: the least deceleration of a move that brakes to rest first.
  MotionProfile(double distance_units, double speed_units_per_s, const ProfileLimits& limits,
                double braking_units_per_s2 = 0.0);

  double duration_s() const;
  // Both from the start of the move, 0 <= t_s <= duration_s().
  double distance_units(double t_s) const;
  double speed_units_per_s(double t_s) const;

 private:
  struct Phase {
    double duration_s = 0.0;
    double start_units = 0.0;
    double speed_units_per_s = 0.0;  // at its start
    double acceleration_units_per_s2 = 0.0;
  };
  static constexpr std::size_t kPhases = 4;  // brake, change of speed, cruise, decelerate

  // Appends a phase that goes from where the last one ended to another speed.
  void change_speed(double speed_units_per_s, double acceleration_units_per_s2);
  void cruise(double distance_units);
  // The phase in which `t_s` lies; `t_s` becomes the time since its start.
  const Phase& phase_at(double& t_s) const;

  std::array<Phase, kPhases> phases_;
  std::size_t count_ = 0;
  double position_units_ = 0.0;  // while it is being built: where the last phase ends,
  double speed_units_per_s_;     // and how fast
};

}  // namespace koboshi::sim_board
