#pragma once

#include <array>
#include <optional>

#include "sim_board/board/sim_board.h"
#include "sim_board/scenario/scenario.h"
#include "sim_board/sensor/ankle_zmp.h"
#include "sim_board/world/foot.h"
#include "simulation/observe/statistics.h"

namespace koboshi::simulation {

// Holds the ZMP by the ankle sensors (sim_board/sensor/ankle_zmp.h: with their errors, without filter and
// delay) to the engine's contact forces: each foot in its own sole's frame, whenever both say that it
// carries at least kLeastLoad_N.
class ZmpSensorCheck {
 public:
  // A sixth of the robot. The sensor does not see what the foot's own mass takes when it touches down: of the
  // ZMP of a foot that has just taken a newton that is millimetres (in a walk 1.0 mm RMS above 1 N, 0.8 mm
  // above 2 N, and with the foot's acceleration known less than 0.1 um), so that it says little.
  static constexpr double kLeastLoad_N = 2.0;

  // The robot must outlive the check.
  ZmpSensorCheck(const sim::RobotDescription& robot, const sim::Scenario& scenario);

  // After a step of the board's physics, at most once for each.
  void observe(const sim::SimBoard& board);
  // Of the distance between the two; not a number when no foot was loaded.
  double rms_m() const { return error_.value(); }
  void archive(sim::StateArchive& archive) { archive(sensors_, error_); }

 private:
  const sim::RobotDescription& robot_;
  std::array<std::optional<sim::Foot>, 2> feet_;
  std::array<std::optional<sim::AnkleZmp>, 2> sensors_;
  RootMeanSquare error_;
};

}  // namespace koboshi::simulation
