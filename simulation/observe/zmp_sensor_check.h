#pragma once

#include <array>
#include <optional>

#include "sim_board/board/sim_board.h"
#include "sim_board/sensor/ankle_zmp.h"
#include "sim_board/world/foot.h"
#include "simulation/observe/statistics.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Compares the ZMP from the ankle sensors (sim_board/sensor/ankle_zmp.h: with their errors, without filter
// and delay) with the engine's contact forces. Each foot is compared in its own sole's frame while both
// report a load of at least kMinLoad_N.
class ZmpSensorCheck {
 public:
  // A sixth of the robot's weight. At touchdown the sensor does not measure the inertial force of the foot
  // itself, which shifts the ZMP by millimetres at a load of 1 N. Measured in a walk: 1.0 mm RMS above 1 N,
  // 0.8 mm above 2 N, and less than 0.1 um with the foot's acceleration known.
  static constexpr double kMinLoad_N = 2.0;

  // The robot must outlive the check.
  ZmpSensorCheck(const sim_board::RobotDescription& robot, const Scenario& scenario);

  // Compares the present state; call it at most once after each step of the board's physics.
  void observe(const sim_board::SimBoard& board);
  // RMS distance of the two ZMPs; NaN if no foot was loaded.
  double rms_m() const { return error_.value(); }
  void archive(sim_board::StateArchive& archive);

 private:
  const sim_board::RobotDescription& robot_;
  std::array<std::optional<sim_board::Foot>, 2> feet_;
  std::array<std::optional<sim_board::AnkleZmp>, 2> sensors_;
  RootMeanSquare error_;
};

}  // namespace koboshi::simulation
