#include "lab/trial/landings.h"

#include <algorithm>
#include <numeric>

#include "sim_board/world/gravity.h"
#include "simulation/observe/statistics.h"

namespace koboshi::lab {
namespace {

constexpr double kTouchdown = 1.0 / 12.0;  // of the weight
constexpr double kSwing = kTouchdown / 2.0;

const sim_board::AnkleSensorDescription* force_sensor(
    const std::optional<sim_board::AnkleSensorDescription>& sensor) {
  const bool measures =
      sensor && (sensor->kind == hal::AnkleKind::kSixAxis || sensor->kind == hal::AnkleKind::kPressureCells);
  return measures ? &*sensor : nullptr;
}

}  // namespace

Landings::Landings(const sim_board::RobotDescription& robot)
    : sensors_{force_sensor(robot.left_ankle), force_sensor(robot.right_ankle)},
      weight_N_(robot.total_mass_kg() * sim_board::kGravity_m_per_s2) {}

void Landings::observe(const simulation::Simulation& simulation) {
  const sim_board::SimBoard& board = simulation.board();
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    if (sensors_[i] == nullptr) continue;
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
  const sim_board::AnkleSensorDescription& sensor = *sensors_[foot];
  int counts = sample.force_raw[2];
  if (sensor.kind == hal::AnkleKind::kPressureCells)
    counts = std::accumulate(sample.force_raw.begin(), sample.force_raw.end(), int{sample.torque_raw[0]});
  return sensor.force.resolution * counts;
}

std::optional<double> Landings::peak(double share) const {
  if (peaks_.empty()) return std::nullopt;
  return simulation::percentile(peaks_, share);
}

}  // namespace koboshi::lab
