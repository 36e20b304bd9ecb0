#include "lab/bring_up/play.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/text/text.h"
#include "sim_board/world/foot.h"
#include "simulation/assembly/operator_input.h"
#include "simulation/batch/parallel.h"
#include "simulation/observe/event_words.h"

namespace koboshi::lab {
namespace {

using behaviour::State;
using simulation::WatchedSimulation;

constexpr double kLost_rad = 0.6;  // a trunk that leans so far does not come back
// The robot boots, is released at 3.5 s, and has measured its gyro's bias.
constexpr std::uint64_t kReady_us = 5'000'000;
constexpr std::uint64_t kStandsFrom_us = 4'000'000;  // from here on a lean counts
constexpr double kTick_s = 0.01;
constexpr std::size_t kSagWindow = 50;  // ticks

std::string touching_of(const WatchedSimulation& world) {
  for (const simulation::RunEvent& event : world.recorder().events().events()) {
    if (event.text.find("touch") != std::string::npos) return event.text;
  }
  return {};
}

// Collects the torques and the sag of the joints.
class JointUses {
 public:
  explicit JointUses(std::size_t joints) : uses_(joints), squares_(joints), errors_(joints) {}

  void observe(const simulation::Telemetry& telemetry) {
    ++ticks_;
    for (std::size_t i = 0; i < uses_.size(); ++i) {
      const simulation::Telemetry::Joint& joint = telemetry.joints[i];
      const double torque = 1e-3 * std::abs(joint.torque_permille);
      uses_[i].torque = std::max(uses_[i].torque, torque);
      squares_[i] += torque * torque;
      // Blocks instead of a sliding window: the sag that counts lasts for seconds.
      errors_[i] += std::abs(joint.target_rad - joint.position_rad);
      if (ticks_ % kSagWindow != 0) continue;
      uses_[i].sag_rad = std::max(uses_[i].sag_rad, errors_[i] / kSagWindow);
      errors_[i] = 0.0;
    }
  }

  std::vector<JointUse> uses() const {
    std::vector<JointUse> uses = uses_;
    for (std::size_t i = 0; i < uses.size() && ticks_ > 0; ++i)
      uses[i].rms_torque = std::sqrt(squares_[i] / static_cast<double>(ticks_));
    return uses;
  }

 private:
  std::vector<JointUse> uses_;
  std::vector<double> squares_;
  std::vector<double> errors_;
  std::size_t ticks_ = 0;
};

// The way from the middle of a play to its end.
class SecondHalf {
 public:
  void observe(const simulation::GroundTruth& truth) {
    if (!start_p_) {
      start_p_ = truth.p_WB_W;
      start_yaw_rad_ = last_yaw_rad_ = truth.rpy_rad.z();
      return;
    }
    turned_rad_ += std::remainder(truth.rpy_rad.z() - last_yaw_rad_, 2.0 * M_PI);
    last_yaw_rad_ = truth.rpy_rad.z();
    end_p_ = truth.p_WB_W;
    time_s_ += kTick_s;
  }

  void write(Played& played) const {
    if (!start_p_ || time_s_ == 0.0) return;
    const Eigen::Vector3d way = end_p_ - *start_p_;
    const double c = std::cos(start_yaw_rad_);
    const double s = std::sin(start_yaw_rad_);
    played.speed_m_per_s = {(way.x() * c + way.y() * s) / time_s_, (way.y() * c - way.x() * s) / time_s_};
    played.turn_rad_per_s = turned_rad_ / time_s_;
  }

 private:
  std::optional<Eigen::Vector3d> start_p_;
  Eigen::Vector3d end_p_ = Eigen::Vector3d::Zero();
  double start_yaw_rad_ = 0.0;
  double last_yaw_rad_ = 0.0;
  double turned_rad_ = 0.0;
  double time_s_ = 0.0;
};

// Names the first link but the feet that touches the ground while the robot is up.
void look_at_ground(const WatchedSimulation& world, Played& played) {
  if (!played.on_ground.empty() || played.lost) return;
  const sim_board::RobotDescription& robot = world.simulation().robot();
  const auto feet = sim_board::feet_of(robot);
  for (const sim_board::Contact& contact : world.simulation().board().world().contacts()) {
    const bool is_foot =
        std::ranges::any_of(feet, [&](const auto& foot) { return foot && foot->link == contact.link; });
    if (contact.other_link < 0 && !is_foot)
      played.on_ground = robot.links[static_cast<std::size_t>(contact.link)].name;
  }
}

// Returns whether the robot is not lost.
bool observe(const WatchedSimulation& world, Played& played) {
  const simulation::GroundTruth& truth = world.recorder().truth();
  look_at_ground(world, played);
  played.lean_rad = std::max(played.lean_rad, truth.tilt_rad);
  played.state = world.recorder().telemetry().state;
  played.reason = simulation::name_of(world.recorder().telemetry().reason);
  if (truth.tilt_rad > kLost_rad && !played.lost) {
    played.lost = true;
    played.at_s = 1e-6 * (static_cast<double>(world.now_us()) - static_cast<double>(kReady_us));
  }
  return !played.lost;
}

void end_by(const sim_board::WorldBlewUp& error, const WatchedSimulation& world, Played& played) {
  played.lost = true;
  played.at_s = 1e-6 * (static_cast<double>(world.now_us()) - static_cast<double>(kReady_us));
  played.reason = one_line(error.what());
}

}  // namespace

struct ReadyRobots::Ready {
  std::uint64_t seed = 0;
  std::optional<WatchedSimulation> world;
  std::optional<simulation::Snapshot> snapshot;
  Played before;  // the command
};

ReadyRobots::ReadyRobots(std::shared_ptr<const simulation::PreparedScenario> prepared,
                         std::uint64_t first_seed, std::size_t count, std::size_t jobs, GoOn go_on)
    : prepared_(std::move(prepared)), jobs_(jobs), go_on_(std::move(go_on)), robots_(count) {
  for (std::size_t i = 0; i < count; ++i) {
    robots_[i] = std::make_unique<Ready>();
    robots_[i]->seed = first_seed + i;
  }
  simulation::for_each_parallel(count, jobs_, [&](std::size_t i) { make_ready(*robots_[i]); });
}

ReadyRobots::~ReadyRobots() = default;

void ReadyRobots::make_ready(Ready& ready) {
  WatchedSimulation& world = ready.world.emplace(prepared_, ready.seed);
  try {
    while (world.now_us() < kReady_us) {
      if (!go_on_()) throw Stopped();
      world.step(10);
      if (world.now_us() > kStandsFrom_us && !observe(world, ready.before)) return;
    }
  } catch (const sim_board::WorldBlewUp& error) {
    return end_by(error, world, ready.before);
  }
  ready.snapshot = world.snapshot();
}

std::vector<Played> ReadyRobots::play(const std::string& command, double for_s,
                                      const MakeWatcher& make_watcher) {
  std::vector<Watcher> watchers(robots_.size());
  for (std::size_t i = 0; make_watcher && i < robots_.size(); ++i) watchers[i] = make_watcher(i);
  std::vector<Played> all(robots_.size());
  simulation::for_each_parallel(robots_.size(), jobs_, [&](std::size_t i) {
    all[i] = play_one(*robots_[i], command, for_s, watchers[i]);
  });
  return all;
}

Played ReadyRobots::play_one(Ready& ready, const std::string& command, double for_s,
                             const Watcher& watcher) const {
  Played played = ready.before;
  if (played.lost) return played;
  WatchedSimulation& world = *ready.world;
  JointUses uses(prepared_->robot.joints.size());
  SecondHalf half;
  world.restore(*ready.snapshot);
  const std::uint64_t end_us = kReady_us + static_cast<std::uint64_t>(1e6 * for_s);
  try {
    if (!command.empty()) simulation::command(world.simulation(), command);
    while (world.now_us() < end_us) {
      if (!go_on_()) throw Stopped();
      world.step(10);
      uses.observe(world.recorder().telemetry());
      if (watcher) watcher(world, 1e-6 * static_cast<double>(world.now_us() - kReady_us));
      if (!observe(world, played)) break;
      if (world.now_us() >= (kReady_us + end_us) / 2) half.observe(world.recorder().truth());
    }
  } catch (const sim_board::WorldBlewUp& error) {
    end_by(error, world, played);
  }
  if (!played.lost) half.write(played);
  played.joints = uses.uses();
  played.touching = touching_of(world);
  return played;
}

std::size_t losses(const std::vector<Played>& all, State state) {
  return static_cast<std::size_t>(
      std::ranges::count_if(all, [&](const Played& one) { return one.lost || one.state != state; }));
}

std::string grounded_link(const std::vector<Played>& all) {
  const auto found = std::ranges::find_if(all, [](const Played& one) { return !one.on_ground.empty(); });
  return found == all.end() ? std::string() : found->on_ground;
}

std::string cause_of(const std::vector<Played>& all, State state) {
  for (const Played& one : all) {
    if (!one.lost && one.state == state) continue;
    std::string cause;
    if (!one.lost) {
      cause = fmt::format("the robot is {}: {}", simulation::name_of(one.state), one.reason);
    } else if (one.at_s < 0.0) {
      cause = fmt::format("{} of {} robots fall before the command", losses(all, state), all.size());
    } else {
      cause = fmt::format("{} of {} robots fall, the first {:.1f} s after the command", losses(all, state),
                          all.size(), one.at_s);
    }
    if (!one.on_ground.empty()) cause += "; " + one.on_ground + " touches the ground";
    if (!one.touching.empty()) cause += "; " + one.touching;
    return cause;
  }
  return "it is not lost";
}

double largest_lean_rad(const std::vector<Played>& all) {
  double value = 0.0;
  for (const Played& one : all) value = std::max(value, one.lean_rad);
  return value;
}

LargestUse largest_use(const std::vector<Played>& all, const sim_board::RobotDescription& robot,
                       double JointUse::*member) {
  LargestUse largest;
  for (const Played& one : all) {
    for (std::size_t joint = 0; joint < one.joints.size(); ++joint) {
      if (one.joints[joint].*member <= largest.value) continue;
      largest = {robot.joints[joint].name, one.joints[joint].*member};
    }
  }
  return largest;
}

}  // namespace koboshi::lab
