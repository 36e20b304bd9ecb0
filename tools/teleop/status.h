#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "simulation/observe/telemetry.h"

namespace koboshi::tools {

// The data on the operator's screen.
struct TeleopStatus {
  struct Velocity {
    double forward_m_per_s = 0.0;
    double left_m_per_s = 0.0;
    double turn_rad_per_s = 0.0;
  };

  std::string scenario;  // its file
  std::string bus;       // address of the bus; empty without a transport
  std::string page;      // address of the live view; empty without one
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
  std::optional<double> zmp_margin_m;               // of the true ZMP, positive inside the support polygon
  std::optional<double> supply_V;                   // lowest voltage that a drive measures
  double push_N_s = 0.0;
  bool aims = false;  // the next direction key gives a push
  std::string last_key;
  std::string effect;        // of that key
  std::string last_command;  // on the bus, from any sender, with its outcome
  std::string last_event;
  std::vector<std::string> map{};  // of TrailMap
};

// Formats the status in at most 24 lines of at most 80 characters, with the map at the right and the keys
// below. Shows a robot that lies as lying, even if its controller has not noticed.
[[nodiscard]] std::vector<std::string> status_lines(const TeleopStatus& status);

// Returns the control sequences that draw these lines on a screen with this many rows, without scrolling.
[[nodiscard]] std::string screen_of(const std::vector<std::string>& lines, std::size_t rows);

}  // namespace koboshi::tools
