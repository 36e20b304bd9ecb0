#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "sim_board/board/sim_board.h"
#include "sim_board/description/description.h"
#include "simulation/observe/ground_truth.h"
#include "simulation/observe/telemetry.h"
#include "simulation/record/trace.h"

namespace koboshi::simulation {

// The state of firmware and world after a tick. Points are in the world frame, so that a figure can lay them
// over the footprints; NaN where there is none.
struct TraceSample {
  const Telemetry& told;  // by the firmware and the drives
  const GroundTruth& truth;
  const sim_board::SimBoard& board;
  Eigen::Vector3d zmp_W;          // measured by the firmware
  Eigen::Vector3d planned_zmp_W;  // by the gait
  Eigen::Vector3d com_W;          // estimated by the firmware
};

// Neighbouring columns of trace.csv whose cells are computed together.
struct TraceFields {
  std::vector<TraceColumn> columns;
  // Appends the value of each column.
  std::function<void(const TraceSample& sample, std::vector<TraceValue>& row)> append;
};

// All columns of the trace but its first, the time: of the controller, of the world, of each joint.
std::vector<TraceFields> trace_fields(const sim_board::RobotDescription& robot);

}  // namespace koboshi::simulation
