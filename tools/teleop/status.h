#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "simulation/observe/telemetry.h"

namespace koboshi::tools {

// What an operator is shown. Velocities ahead and to the left, and counter-clockwise.
struct TeleopStatus {
  struct Velocity {
    double forward_m_per_s = 0.0;
    double left_m_per_s = 0.0;
    double turn_rad_per_s = 0.0;
  };

  std::string scenario;  // its file
  std::string bus;       // where others find it; empty where they do not
  double simulated_s = 0.0;
  double real_time_factor = 0.0;
  std::uint64_t overruns = 0;
  std::uint64_t largest_delay_us = 0;
  bool held = false;  // by the stand
  std::size_t falls = 0;
  double tilt_rad = 0.0;  // of the trunk, true
  simulation::Telemetry said;
  Velocity commanded;
  Velocity measured;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // true x, y [m] and heading [rad]
  std::optional<double> zmp_margin_m;               // of the true one, inside the support polygon
  std::optional<double> supply_V;                   // the lowest that a drive measures
  double push_N_s = 0.0;
  bool aims = false;  // the next direction is that of a push
  std::string last_key;
  std::string effect;        // of that key
  std::string last_command;  // on the bus, whoever gave it, and what became of it
  std::string last_event;
  std::vector<std::string> map{};  // of TrailMap
};

// The status in at most 24 lines of at most 80 characters, with the map at the right and the keys below. A
// robot that lies is never shown as standing, whatever its controller says.
[[nodiscard]] std::vector<std::string> status_lines(const TeleopStatus& status);

// What draws these lines over a screen of so many rows: each in its place, so that nothing ever scrolls.
[[nodiscard]] std::string screen_of(const std::vector<std::string>& lines, std::size_t rows);

}  // namespace koboshi::tools
