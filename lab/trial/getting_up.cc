#include "lab/trial/getting_up.h"

#include <algorithm>
#include <cmath>

#include "simulation/observe/posture.h"

namespace koboshi::lab {
namespace {

constexpr std::uint64_t kSteady_us = 500'000;  // of standing, after which nothing more happens

}  // namespace

GettingUp::GettingUp(const simulation::Scenario& scenario) : begin_us_(scenario.duration_us) {
  using Kind = simulation::Command::Kind;
  for (const simulation::Command& command : scenario.commands) {
    if (command.kind == Kind::kPlay || command.kind == Kind::kGetUp)
      begin_us_ = std::min(begin_us_, command.at_us);
  }
}

bool GettingUp::observe(const simulation::GroundTruth& truth, std::uint64_t now_us) {
  const double height = std::clamp(truth.height_m / truth.pose_height_m, 0.0, 1.0);
  uprightness_ = 0.25 * (1.0 + std::cos(truth.tilt_rad)) + 0.5 * height;
  const bool stands = now_us >= begin_us_ && simulation::stands_still(truth);
  if (!stands) {
    stands_since_us_.reset();
  } else if (!stands_since_us_) {
    stands_since_us_ = now_us;
  }
  return stands_since_us_ && now_us >= *stands_since_us_ + kSteady_us;
}

std::optional<double> GettingUp::stood_s() const {
  if (!stands_since_us_) return std::nullopt;
  return 1e-6 * static_cast<double>(*stands_since_us_ - begin_us_);
}

GettingUpTrial play_getting_up(const simulation::Scenario& scenario, std::uint64_t seed) {
  GettingUp getting_up(scenario);
  const auto is_over = [&](const simulation::Simulation& simulation,
                           const simulation::RunRecorder& recorder) {
    const std::uint64_t now_us = simulation.board().now_us();
    return now_us > 0 && now_us % sim_board::SimBoard::kTick_us == 0 &&
           getting_up.observe(recorder.truth(), now_us);
  };
  GettingUpTrial trial{watch_in_world(scenario, seed, is_over)};
  if (trial.error.empty()) trial.stood_s = getting_up.stood_s();
  trial.uprightness = getting_up.uprightness();
  return trial;
}

}  // namespace koboshi::lab
