#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "sim_board/board/sim_board.h"
#include "sim_board/record/trace.h"
#include "sim_board/robot/description.h"
#include "simulation/observe/ground_truth.h"
#include "simulation/observe/telemetry.h"

namespace koboshi::simulation {

// The state of firmware and world after a tick. Points are in the world frame, so that a figure can lay them
// over the footprints; NaN where there is none.
struct TraceSample {
  const Telemetry& told;  // by the firmware and the drives
  const GroundTruth& truth;
  const sim::SimBoard& board;
  Eigen::Vector3d zmp_W;          // measured by the firmware
  Eigen::Vector3d planned_zmp_W;  // by the gait
  Eigen::Vector3d com_W;          // estimated by the firmware
};

// A column of trace.csv and the value of its cells.
struct TraceField {
  sim::TraceColumn column;
  std::function<sim::TraceValue(const TraceSample&)> value;
};

// All columns of the trace but its first, the time: of the controller, of the world, of each joint.
std::vector<TraceField> trace_fields(const sim::RobotDescription& robot);

}  // namespace koboshi::simulation
