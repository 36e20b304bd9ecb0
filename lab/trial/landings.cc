#include "lab/trial/landings.h"

#include <algorithm>
#include <numeric>

#include "firmware/estimation/zmp.h"
#include "sim_board/world/gravity.h"
#include "simulation/observe/statistics.h"

namespace koboshi::lab {
namespace {

// Shares of the weight.
constexpr double kTouchdown = 1.0 / estimation::FootSensor::kWeightPerMinLoad;
constexpr double kSwing = kTouchdown / 2.0;

}  // namespace

Landings::Sensor Landings::sensor(const std::optional<sim_board::AnkleSensorDescription>& description) {
  if (!description) return {};
  const bool cells = description->kind == hal::AnkleKind::kPressureCells;
  if (!cells && description->kind != hal::AnkleKind::kSixAxis) return {};
  return {.cells = cells, .resolution_N = description->force.resolution};
}

Landings::Landings(const sim_board::RobotDescription& robot)
    : sensors_{sensor(robot.left_ankle), sensor(robot.right_ankle)},
      weight_N_(robot.total_mass_kg() * sim_board::kGravity_m_per_s2) {}

void Landings::observe(const simulation::Simulation& simulation) {
  const sim_board::SimBoard& board = simulation.board();
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    if (sensors_[i].resolution_N == 0.0) continue;
    Foot& foot = feet_[i];
    const double load = load_N(board, i);
    if (foot.landed_us) {
      foot.peak_N = std::max(foot.peak_N, load);
      if (board.now_us() < *foot.landed_us + kImpact_us) continue;
      peaks_.push_back(foot.peak_N / weight_N_);
      foot = {};
    } else if (load < kSwing * weight_N_) {
      foot.swings = true;
    } else if (foot.swings && load >= kTouchdown * weight_N_) {
      foot = {.landed_us = board.now_us(), .peak_N = load};
    }
  }
}

double Landings::load_N(const sim_board::SimBoard& board, std::size_t foot) const {
  const hal::AnkleSample& sample = board.electronics().last_input().ankles[foot];
  int counts = sample.force_raw[2];
  if (sensors_[foot].cells)
    counts = std::accumulate(sample.force_raw.begin(), sample.force_raw.end(), int{sample.torque_raw[0]});
  return sensors_[foot].resolution_N * counts;
}

std::optional<double> Landings::peak(double share) const {
  if (peaks_.empty()) return std::nullopt;
  return simulation::percentile(peaks_, share);
}

}  // namespace koboshi::lab
