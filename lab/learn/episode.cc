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
  WalkSums(const Eigen::Vector3d& velocity, CycleObserver* observer)
      : velocity_(velocity), observer_(observer) {}

  void set_policy(const policy::Policy& policy) { policy_ = policy; }
  void begin_cycle(policy::Residual& residual) {
    if (observer_ != nullptr) residual.deviate(observer_->deviations());
  }
  void end_cycle(const simulation::InProcessHost& host) {
    if (host.values().policy.state == app::PolicyState::kStopped) stopped_ = true;
    offset_ = mean_square_offset(host.residual());
    if (observer_ == nullptr) return;
    finish_cycle();
    runs_ = host.values().policy.state == app::PolicyState::kActive;
    if (runs_) observer_->cycle(host.residual().signals());
  }
  void add(simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
    const double drawn_J = simulation.board().electronics().drawn_J();
    const double energy_J = drawn_J - std::exchange(drawn_J_, drawn_J);
    if (recorder.telemetry().state != behaviour::State::kWalking) return;
    RewardTerms now{.walk_s = all_.walk_s + kMillisecond_s};
    const Eigen::Vector3d off = recorder.walk().displacement() - led_to(velocity_, now.walk_s);
    now.drift_m = off.head<2>().norm();
    now.turn_rad = std::abs(off.z());
    now.energy_J = all_.energy_J + energy_J;
    const double tilt_rad = recorder.truth().tilt_rad;
    now.lean_rad2_s = all_.lean_rad2_s + kMillisecond_s * tilt_rad * tilt_rad;
    now.offset_s = all_.offset_s + kMillisecond_s * offset_;
    all_ = now;
  }
  void finish(Episode& episode) {
    finish_cycle();
    if (all_.walk_s <= 0.0) return;
    episode.lean_rad2 = all_.lean_rad2_s / all_.walk_s;
    episode.offset = all_.offset_s / all_.walk_s;
    episode.policy_stopped = stopped_;
  }

 private:
  static constexpr double kMillisecond_s = 1e-3;

  double mean_square_offset(const policy::Residual& residual) const {
    if (policy_.output_count() == 0) return 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < policy_.output_count(); ++i) {
      const double share = fixed::to_double(residual.offset(i)) / fixed::to_double(policy_.output(i).bound);
      sum += share * share;
    }
    return sum / static_cast<double>(policy_.output_count());
  }
  void finish_cycle() {
    if (observer_ != nullptr && runs_)
      observer_->earned({.walk_s = all_.walk_s - told_.walk_s,
                         .drift_m = all_.drift_m - told_.drift_m,
                         .turn_rad = all_.turn_rad - told_.turn_rad,
                         .energy_J = all_.energy_J - told_.energy_J,
                         .lean_rad2_s = all_.lean_rad2_s - told_.lean_rad2_s,
                         .offset_s = all_.offset_s - told_.offset_s});
    runs_ = false;
    told_ = all_;
  }

  const Eigen::Vector3d velocity_;
  CycleObserver* const observer_;
  policy::Policy policy_;
  RewardTerms all_{};   // since the walk began
  RewardTerms told_{};  // to the observer
  double drawn_J_ = 0.0;
  double offset_ = 0.0;
  bool runs_ = false;  // the policy ran in the last cycle
  bool stopped_ = false;
};

// The host of an episode. Tells the sums of every cycle.
class LearningHost final : public sim_board::ControllerHost {
 public:
  LearningHost(std::span<const std::byte> contents, WalkSums& sums) : host_(contents), sums_(sums) {}

  void exchange(const hal::BatchInput& input, hal::BatchOutput& output) override {
    if (input.tick) sums_.begin_cycle(host_.residual());
    host_.exchange(input, output);
    if (input.tick) sums_.end_cycle(host_);
  }
  void archive(sim_board::StateArchive& archive) override { host_.archive(archive); }

 private:
  simulation::InProcessHost host_;
  WalkSums& sums_;
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
                            CycleObserver* observer) const {
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
  WalkSums sums(course.velocity, observer);
  const std::vector<std::byte> aligned(image.begin(), image.end());
  policy::Policy policy;
  if (!image.empty() && policy::Policy::open(aligned, prepared.model.model, policy).ok())
    sums.set_policy(policy);
  const auto make_host = [&sums](std::span<const std::byte> contents) {
    return std::make_unique<LearningHost>(contents, sums);
  };
  Episode episode;
  static_cast<ScenarioTrial&>(episode) = watch_prepared(
      std::make_shared<const simulation::PreparedScenario>(std::move(prepared)), seed, make_host,
      [&](simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
        sums.add(simulation, recorder);
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

double reward_of(const RewardTerms& terms, const RewardWeights& weights, double walk_s) {
  return (weights.survival * terms.walk_s - weights.drift * terms.drift_m - weights.turn * terms.turn_rad -
          weights.power * terms.energy_J - weights.lean * terms.lean_rad2_s -
          weights.offset * terms.offset_s) /
         walk_s;
}

double reward_of(const Episode& episode, const RewardWeights& weights, double walk_s) {
  const double survival = episode.lost() ? std::min(1.0, episode.walk_s / walk_s) - 1.0 : 1.0;
  return weights.survival * survival - weights.drift * episode.drift_m_per_s -
         weights.turn * episode.turn_rad_per_s - weights.power * episode.power_W -
         weights.lean * episode.lean_rad2 - weights.offset * episode.offset;
}

}  // namespace koboshi::lab
