#include "lab/trial/motion_measure.h"

#include <algorithm>

namespace koboshi::lab {
namespace {

constexpr double kUnloaded_N = 0.1;
constexpr double kLifted_m = 0.005;
constexpr double kFree_s = 0.2;
constexpr double kRise_m = 0.020;

// Whether anything of the robot touches the ground but links at which no other link hangs.
bool lies(const simulation::Simulation& simulation) {
  return std::ranges::any_of(simulation.board().world().contacts(), [&](const sim_board::Contact& contact) {
    return contact.other_link < 0 &&
           std::ranges::any_of(simulation.robot().joints, [&](const sim_board::JointDescription& joint) {
             return joint.parent == contact.link;
           });
  });
}

}  // namespace

void OneLegTime::observe(const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
  const simulation::GroundTruth& truth = recorder.truth();
  int lifted = -1;
  for (const int foot : {0, 1}) {
    const auto side = static_cast<std::size_t>(foot);
    if (foot == only_.value_or(foot) && truth.foot_load_N[side] < kUnloaded_N &&
        truth.foot_height_m[side] > kLifted_m && truth.foot_load_N[1 - side] > kUnloaded_N)
      lifted = foot;
  }
  const double time_s = simulation.board().world().time_s();
  if (lifted != lifted_) since_s_ = time_s;
  lifted_ = lifted;
  if (lifted >= 0) longest_s_ = std::max(longest_s_, time_s - since_s_);
}

void BallSpeed::observe(const simulation::Simulation& simulation, const simulation::RunRecorder&) {
  const sim_board::World& world = simulation.board().world();
  if (world.free_bodies().empty()) return;
  if (world.links_at_free_bodies()[0] >= 0) {
    touched_s_ = world.time_s();
    is_free_ = false;
  } else if (touched_s_ && !is_free_ && world.time_s() >= *touched_s_ + kFree_s) {
    is_free_ = true;
    speed_m_per_s_ = std::max(speed_m_per_s_, world.free_bodies()[0].v_WF_W.head<2>().norm());
  }
}

void PushUps::observe(const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
  const double height_m = recorder.truth().p_WB_W.z();
  if (is_up_) {
    turn_m_ = std::max(turn_m_, height_m);
    if (height_m < turn_m_ - kRise_m) {
      is_up_ = false;
      turn_m_ = height_m;
    }
    return;
  }
  // A trunk that rises while it or the knees bear the robot is not pushed up. The next rise begins from here.
  if (height_m < turn_m_ || lies(simulation)) turn_m_ = height_m;
  if (height_m < turn_m_ + kRise_m) return;
  is_up_ = true;
  turn_m_ = height_m;
  ++count_;
}

}  // namespace koboshi::lab
