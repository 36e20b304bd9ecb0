#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "firmware/policy/residual.h"
#include "firmware/policy/signals.h"
#include "lab/learn/learning_study.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/scenario_trial.h"
#include "simulation/assembly/prepared_scenario.h"

namespace koboshi::lab {

// A walk with a policy, and what its reward is made of. All means are over the walk.
struct Episode : ScenarioTrial {
  double walk_s = 0.0;          // until the end, or the loss
  double drift_m_per_s = 0.0;   // distance from where the command leads to, over the time
  double turn_rad_per_s = 0.0;  // the same of the heading, unsigned
  double power_W = 0.0;         // drawn from the supply
  double lean_rad2 = 0.0;       // mean square of the trunk's angle from the vertical
  double offset = 0.0;          // mean square of the offsets as shares of their bounds
  bool policy_stopped = false;  // by its watchdog
};

// How much the terms of the reward have grown. Over a whole walk they are the means of its episode, times its
// duration.
struct RewardTerms {
  double walk_s = 0.0;
  double drift_m = 0.0;
  double turn_rad = 0.0;
  double energy_J = 0.0;
  double lean_rad2_s = 0.0;
  double offset_s = 0.0;
};

// Follows the cycles of the controller in which the policy has run, and may deviate from its outputs.
class CycleObserver {
 public:
  virtual ~CycleObserver() = default;

  // Deviations from the outputs of the next cycle, if the policy runs in it.
  virtual policy::Residual::Deviations deviations() { return {}; }
  // A cycle, with what the policy saw.
  virtual void cycle(const policy::Signals::Values& signals) = 0;
  // The growth of the reward's terms between this cycle and the next one, or the end of the walk.
  virtual void earned(const RewardTerms&) {}
};

// Plays walks of one scenario with different policies, commands, pushes and worlds. Files are read and
// compiled once.
class EpisodePlayer {
 public:
  // `overrides` are those of the scenario. Throws InputError.
  EpisodePlayer(const std::filesystem::path& scenario, std::span<const Override> overrides);

  // The commands, and the pushes that the robot gets.
  struct Course {
    std::string world = "mild";
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    double walk_s = 10.0;
    struct Shove {
      double at_s = 0.0;  // since the command to walk
      double duration_s = 0.1;
      Eigen::Vector2d impulse_N_s_per_kg = Eigen::Vector2d::Zero();  // forward, to the left
    };
    std::vector<Shove> pushes{};
  };

  // Plays a course in the world of a seed; ends early when the robot has fallen. An empty image is the engine
  // alone. From any number of threads. Throws InputError for an image that the robot refuses.
  [[nodiscard]] Episode play(std::span<const std::byte> image, const Course& course, std::uint64_t seed,
                             CycleObserver* observer = nullptr) const;

  [[nodiscard]] const simulation::NamedModel& model() const { return prepared_->model; }
  [[nodiscard]] const simulation::Scenario& scenario() const { return start_.scenario; }
  // Duration of two steps.
  [[nodiscard]] double cycle_s() const { return cycle_s_; }
  [[nodiscard]] double full_speed_m_per_s() const { return full_speed_m_per_s_; }

 private:
  StandingStart start_;
  std::shared_ptr<const simulation::PreparedScenario> prepared_;
  double cycle_s_ = 0.0;
  double full_speed_m_per_s_ = 0.0;
};

// Draws the course of a seed in a stage.
[[nodiscard]] EpisodePlayer::Course draw_course(const LearningStage& stage, double walk_s,
                                                std::uint64_t seed);

// The part of the reward that these terms make: the weighted shares of a walk of this duration.
[[nodiscard]] double reward_of(const RewardTerms& terms, const RewardWeights& weights, double walk_s);

// 1 for a robot on its feet at the end, else the share of the time before the loss, less 1; less the weighted
// costs.
[[nodiscard]] double reward_of(const Episode& episode, const RewardWeights& weights, double walk_s);

}  // namespace koboshi::lab
