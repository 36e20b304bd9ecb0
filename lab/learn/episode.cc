#include "lab/learn/episode.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/fixed/host/convert.h"
#include "lab/trial/pushes.h"
#include "sim_board/random/random_stream.h"
#include "simulation/assembly/parameters.h"
#include "simulation/host/in_process_host.h"

namespace koboshi::lab {
namespace {

// From the command to the first push at the earliest: the robot takes its first two steps.
constexpr double kFirstPush_s = 1.0;
// A push so short before the end tells nothing: a robot that is going to fall lies after a second.
constexpr double kAfterLastPush_s = 1.0;

// Where a robot comes with this velocity: forward, left, turn.
Eigen::Vector3d led_to(const Eigen::Vector3d& velocity, double time_s) {
  const double turn_rad = velocity.z() * time_s;
  if (std::abs(turn_rad) < 1e-9) return velocity * time_s;
  const double sine = std::sin(turn_rad) / velocity.z();
  const double rest = (1.0 - std::cos(turn_rad)) / velocity.z();
  return {velocity.x() * sine - velocity.y() * rest, velocity.x() * rest + velocity.y() * sine, turn_rad};
}

// Sums over the walk what a scenario trial does not measure.
class WalkSums {
 public:
  explicit WalkSums(const WatchSignals& watch) : watch_(watch) {}

  void set_host(const simulation::InProcessHost* host) { host_ = host; }
  void add(const simulation::RunRecorder& recorder) {
    if (recorder.telemetry().state != behaviour::State::kWalking) return;
    ++count_;
    const double tilt_rad = recorder.truth().tilt_rad;
    lean_rad2_ += tilt_rad * tilt_rad;
    add_offsets();
  }
  void finish(Episode& episode) const {
    if (count_ == 0) return;
    episode.lean_rad2 = lean_rad2_ / static_cast<double>(count_);
    episode.offset = offset_ / static_cast<double>(count_);
    episode.policy_stopped = stopped_;
  }
  void set_policy(const policy::Policy& policy) { policy_ = policy; }

 private:
  void add_offsets() {
    if (host_ == nullptr || policy_.output_count() == 0) return;
    const policy::Residual& residual = host_->residual();
    double sum = 0.0;
    for (std::size_t i = 0; i < policy_.output_count(); ++i) {
      const double share = fixed::to_double(residual.offset(i)) / fixed::to_double(policy_.output(i).bound);
      sum += share * share;
    }
    offset_ += sum / static_cast<double>(policy_.output_count());
    stopped_ = stopped_ || residual.cause() != policy::Cause::kNone;
    if (watch_ && count_ % kTick_ms == 0) watch_(residual.signals());
  }

  static constexpr std::uint64_t kTick_ms = hal::kControlPeriod_us / 1'000;

  const WatchSignals& watch_;
  const simulation::InProcessHost* host_ = nullptr;
  policy::Policy policy_;
  std::uint64_t count_ = 0;  // milliseconds
  double lean_rad2_ = 0.0;
  double offset_ = 0.0;
  bool stopped_ = false;
};

}  // namespace

EpisodePlayer::EpisodePlayer(const std::filesystem::path& scenario, std::span<const Override> overrides) {
  start_ = read_standing_start({.scenario = scenario}, overrides);
  start_.scenario.policy.reset();
  start_.scenario.parameters.push_back({{"policy_enabled", scenario, 0}, 1.0});
  prepared_ = std::make_shared<const simulation::PreparedScenario>(simulation::prepare(start_.scenario));
  const auto values = simulation::controller_values(start_.scenario);
  cycle_s_ = 2e-3 * values.walk.step.time_ms;
  full_speed_m_per_s_ = 1e-3 * values.velocity_limits.forward_mm_per_s;
}

Episode EpisodePlayer::play(std::span<const std::byte> image, const Course& course, std::uint64_t seed,
                            const WatchSignals& watch) const {
  simulation::PreparedScenario prepared =
      image.empty() ? *prepared_ : simulation::with_policy(*prepared_, image);
  simulation::Scenario scenario = start_.walking(course.velocity, course.walk_s);
  scenario.world = {simulation::world_named(course.world), std::nullopt};
  const double mass_kg = robot_in_world(scenario, prepared.robot_in_world(), seed).total_mass_kg();
  for (const Course::Shove& shove : course.pushes) {
    const Eigen::Vector2d impulse_N_s = mass_kg * shove.impulse_N_s_per_kg;
    scenario.pushes.push_back(half_sine_push(prepared.robot.links.front().name,
                                             start_.ready_us + to_us(shove.at_s), shove.duration_s,
                                             {impulse_N_s.x(), impulse_N_s.y(), 0.0}));
  }
  prepared.scenario = scenario;
  WalkSums sums(watch);
  const std::vector<std::byte> aligned(image.begin(), image.end());
  policy::Policy policy;
  if (!image.empty() && policy::Policy::open(aligned, prepared.model.model, policy).ok())
    sums.set_policy(policy);
  const auto make_host = [&sums](std::span<const std::byte> contents) {
    auto host = std::make_unique<simulation::InProcessHost>(contents);
    sums.set_host(host.get());
    return host;
  };
  Episode episode;
  static_cast<ScenarioTrial&>(episode) =
      watch_prepared(std::make_shared<const simulation::PreparedScenario>(std::move(prepared)), seed,
                     make_host, [&](simulation::Simulation&, const simulation::RunRecorder& recorder) {
                       sums.add(recorder);
                       return recorder.fell();
                     });
  sums.finish(episode);
  episode.walk_s = std::max(0.0, episode.duration_s - 1e-6 * static_cast<double>(start_.ready_us));
  if (!episode.walked() || episode.walk_s <= 0.0) return episode;
  const Eigen::Vector3d came(episode.walk.distance_m, episode.walk.lateral_drift_m,
                             episode.walk.heading_drift_rad);
  const Eigen::Vector3d off = came - led_to(course.velocity, episode.walk_s);
  episode.drift_m_per_s = off.head<2>().norm() / episode.walk_s;
  episode.turn_rad_per_s = std::abs(off.z()) / episode.walk_s;
  episode.power_W = episode.walk.energy_J / episode.walk_s;
  return episode;
}

EpisodePlayer::Course draw_course(const LearningStage& stage, double walk_s, std::uint64_t seed) {
  sim_board::RandomStream random(seed, "episode");
  const auto drawn = [&](const simulation::Range& range) { return between(random, range.low, range.high); };
  EpisodePlayer::Course course{.world = stage.world, .walk_s = walk_s};
  course.velocity.x() = drawn(stage.forward_m_per_s);
  course.velocity.y() = drawn(stage.left_m_per_s);
  course.velocity.z() = drawn(stage.turn_rad_per_s);
  if (stage.impulse_N_s_per_kg.high <= 0.0) return course;
  double at_s = kFirstPush_s + random.uniform() * stage.interval_s.low;
  while (at_s <= walk_s - kAfterLastPush_s) {
    const double impulse = drawn(stage.impulse_N_s_per_kg);
    const double towards_rad = between(random, 0.0, kTurn_rad);
    course.pushes.push_back(
        {.at_s = at_s,
         .duration_s = kPush_s,
         .impulse_N_s_per_kg = {impulse * std::cos(towards_rad), impulse * std::sin(towards_rad)}});
    at_s += drawn(stage.interval_s);
  }
  return course;
}

double reward_of(const Episode& episode, const RewardWeights& weights, double walk_s) {
  const double survival = episode.lost() ? std::min(1.0, episode.walk_s / walk_s) - 1.0 : 1.0;
  return weights.survival * survival - weights.drift * episode.drift_m_per_s -
         weights.turn * episode.turn_rad_per_s - weights.power * episode.power_W -
         weights.lean * episode.lean_rad2 - weights.offset * episode.offset;
}

}  // namespace koboshi::lab
