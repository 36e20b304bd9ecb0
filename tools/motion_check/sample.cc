#include "tools/motion_check/sample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>
#include <utility>

#include "firmware/fixed/host/convert.h"
#include "firmware/motion/interpreter.h"
#include "firmware/motion/program_state.h"
#include "firmware/motion/roles.h"
#include "tools/motion_check/forced_motion.h"
#include "tools/motion_check/longest_way.h"

namespace koboshi::tools {
namespace {

using motion::Interpreter;
using motion::Opcode;

constexpr std::uint32_t kTick_us = 10'000;
constexpr std::uint32_t kFineTick_us = 1'000;
// The first path comes to a condition so often in one pose; then it takes the other outcome, too, so that it
// leaves a loop that sensors end.
constexpr int kMaxVisits = 20;
// Nothing else happens while a condition is polled; after this time the outcome changes.
constexpr std::size_t kMaxPollingTicks = 6'000;
// An expected attitude says that the robot stands again if it is this close to upright.
constexpr double kUpright_rad = 25.0 * std::numbers::pi / 180.0;
// One about an attitude this close to upright leaves a standing robot standing, whatever its tolerance: a
// robot that sits leans more.
constexpr double kStanding_rad = 10.0 * std::numbers::pi / 180.0;

bool begins_on_feet(const motion::Motion& played) {
  const auto name = std::ranges::find(motion::kMotionNames, played.name());
  return name == motion::kMotionNames.end() ||
         motion::begins_on_feet(static_cast<motion::Role>(name - motion::kMotionNames.begin()));
}

bool stands_after(const motion::ExpectedAttitude& expected, bool stands) {
  const double up = expected.up_B[2] / 127.0;
  return (up >= std::cos(kUpright_rad) && expected.min_cosine >= 32768.0 * std::cos(kUpright_rad)) ||
         (stands && up >= std::cos(kStanding_rad));
}

// A condition that is come to in a pose: the step and the targets.
using Visit = std::pair<std::uint16_t, std::vector<std::int32_t>>;

// The visits of all paths so far.
struct Explored {
  // A path that is still to be played: its outcomes one by one; the last of them is the new one.
  using Plan = std::vector<bool>;

  std::map<Visit, std::size_t> visits{};  // with their numbers
  std::deque<Plan> plans{{}};
};

bool are_equal(const motion::Mix& a, const motion::Mix& b) {
  return a.joint == b.joint && a.source == b.source && a.gain == b.gain && a.limit == b.limit;
}

MixBounds bounds_of(std::span<const motion::Mix> mixes) {
  MixBounds bounds;
  for (const motion::Mix& mix : mixes) {
    const double bound_rad = 2.0 * std::numbers::pi * mix.limit / (1 << 16);
    bounds.push_back(
        {mix.joint, static_cast<std::uint8_t>(mix.source), mix.gain < 0 ? -bound_rad : bound_rad});
  }
  return bounds;
}

// Plays one path.
class Player {
 public:
  Player(ForcedMotion& forced, const simulation::NamedModel& robot, Explored& explored, std::size_t path,
         Explored::Plan plan)
      : motion_(forced), robot_(robot), explored_(explored), path_(path), plan_(std::move(plan)) {
    on_feet_ = begins_on_feet(motion_.original());
    motion_.arm(motion::kNoStep);
  }

  Trajectory play(std::span<const double> from_rad, const std::stop_token& cancel) {
    std::vector<fixed::Angle> from;
    for (const double angle_rad : from_rad) from.push_back(fixed::from_double<fixed::Angle>(angle_rad));
    std::optional<Interpreter> now(decided(
        Interpreter(robot_.model), [&](Interpreter& next) { next.start(motion_.forced(), from, inputs_); }));
    add(*now, now->step_index(), on_feet_);
    // A cut path is played on for the time of the hold, so that the analysis does not take the cut for a
    // stop.
    for (std::size_t tick = 0; now->running() && tick < kMaxPathTicks + kHoldTicks && !merged_into_; ++tick) {
      if (cancel.stop_requested()) return {};
      if (tick == kStopTick) stop(*now);
      const Interpreter next = advanced(*now);
      now.emplace(next);
    }
    if (now->running() && !merged_into_) {
      trajectory_.cut = true;
      std::fill(trajectory_.on_feet.end() - kHoldTicks, trajectory_.on_feet.end(), false);
      return std::move(trajectory_);
    }
    trajectory_.merged = merged_into_.has_value();
    trajectory_.failed = !trajectory_.merged && now->failed();
    if (!trajectory_.merged)
      for (std::size_t tick = 0; tick < kHoldTicks; ++tick) add(*now, now->step_index(), on_feet_);
    return std::move(trajectory_);
  }

  // The visit of an earlier path at which this one ends.
  const std::optional<std::size_t>& merged_into() const { return merged_into_; }
  // The visits of this path with their first ticks.
  const std::map<std::size_t, std::size_t>& passed() const { return passed_; }

 private:
  void stop(Interpreter& interpreter) {
    interpreter.stop();
    stopping_ = true;
    trajectory_.stop_tick = trajectory_.ticks();
  }

  // Returns the interpreter after the next tick.
  Interpreter advanced(const Interpreter& now) {
    const std::uint16_t step = now.step_index();
    const bool awaits = motion_.original().opcode(step) == Opcode::kAwait;
    motion_.arm(awaits ? step : motion::kNoStep);
    const bool on_feet = on_feet_;
    Interpreter next = decided(now, [&](Interpreter& at) { at.advance(kTick_us, inputs_); });
    if (merged_into_) return next;
    if (is_late(now, next)) trajectory_.late.push_back(trajectory_.ticks());
    add(next, step, on_feet);  // as the tick began
    return next;
  }

  // Plays on as `play` does, and decides each condition that it comes to.
  template <typename Play>
  Interpreter decided(const Interpreter& from, const Play& play) {
    for (;;) {
      Interpreter next = from;
      play(next);
      const std::uint16_t step = next.step_index();
      if (!next.failed() || !motion_.is_armed(step)) return next;
      if (motion_.original().opcode(step) == Opcode::kExpect) {
        on_feet_ = stands_after(motion::ExpectedAttitude::of(motion_.original().step(step)), on_feet_);
        motion_.satisfy(step);
        continue;
      }
      const std::optional<bool> holds = outcome_of(next);
      if (!holds) return next;
      motion_.decide(step, *holds);
    }
  }

  // Returns the outcome of the condition at which the interpreter is; nothing if the path ends here.
  std::optional<bool> outcome_of(const Interpreter& at) {
    const std::uint16_t step = at.step_index();
    Visit visit{step, {}};
    for (const fixed::Angle target : at.targets()) visit.second.push_back(target.raw() >> motion::kPoseShift);
    const std::size_t tick = trajectory_.ticks();
    const bool planned = taken_.size() < plan_.size();
    if (taken_.size() + 1 == plan_.size()) {
      trajectory_.first_own_tick = tick;
      trajectory_.outcome = Trajectory::Outcome{step, plan_.back()};
    }
    const auto [place, is_new] = explored_.visits.try_emplace(visit, explored_.visits.size());
    const bool natural = holds_naturally(at);
    std::optional<bool> holds = natural;
    Visits& here = visits_[visit];
    const bool polls = here.count > 0 && moved_tick_ < here.last_tick;
    if (planned) {
      holds = plan_[taken_.size()];
    } else if (is_new) {
      explored_.plans.push_back(taken_);
      explored_.plans.back().push_back(!natural);
    } else if (polls) {
      holds = here.holds != (tick - here.first_poll_tick > kMaxPollingTicks);
    } else if (path_ == 0) {
      holds = natural != (here.count > kMaxVisits && here.count % 2 == 0);
    } else {
      merged_into_ = place->second;
      return std::nullopt;
    }
    if (!polls) here.first_poll_tick = tick;
    here.last_tick = tick;
    here.holds = *holds;
    ++here.count;
    passed_.try_emplace(place->second, tick);
    taken_.push_back(*holds);
    return holds;
  }

  // Returns the outcome with sensors that read zero.
  bool holds_naturally(const Interpreter& at) const {
    motion::ProgramState state;
    for (std::size_t i = 0; i < motion::kMaxVariables; ++i)
      static_cast<void>(state.assign({.variable = static_cast<std::uint16_t>(i), .right = at.variables()[i]},
                                     inputs_, at.targets()));
    state.pass(static_cast<std::uint32_t>(trajectory_.ticks()) * kTick_us);
    if (stopping_) state.stop();
    const motion::Motion& original = motion_.original();
    return state.holds(original, at.step_index(), original.step(at.step_index()), inputs_, at.targets());
  }

  // Whether the interpreter had more to do in this tick than it does in one call.
  bool is_late(const Interpreter& before, const Interpreter& after) const {
    if (before.step_index() == after.step_index() && after.running()) return false;
    Interpreter fine = before;
    for (std::uint32_t time_us = 0; time_us < kTick_us; time_us += kFineTick_us)
      fine.advance(kFineTick_us, inputs_);
    const Opcode opcode = motion_.original().opcode(after.step_index());
    const bool waits = after.running() && !motion::takes_time(opcode) && opcode != Opcode::kAwait;
    return waits || fine.step_index() != after.step_index();
  }

  void add(const Interpreter& at, std::uint16_t step, bool on_feet) {
    std::vector<double> row;
    for (const fixed::Angle target : at.targets()) row.push_back(fixed::to_double(target));
    const std::size_t ticks = trajectory_.ticks();
    if (ticks > 0 && !std::ranges::equal(row, trajectory_.row(ticks - 1))) moved_tick_ = ticks;
    note_clamps(at);
    const motion::Lean lean = at.lean();
    trajectory_.add(row, step, on_feet, fixed::to_double(lean.pitch), fixed::to_double(lean.roll));
    note_mixes(at.mixes());
    note_gains(at);
  }

  void note_gains(const Interpreter& at) {
    if (at.regained() == 0) return;
    std::vector<double> gains;
    for (std::size_t j = 0; j < at.targets().size(); ++j)
      gains.push_back(at.gain_percent(j) / double{motion::Gain::kFull});
    trajectory_.gains.back() = trajectory_.index_of(gains);
  }

  void note_mixes(std::span<const motion::Mix> mixes) {
    if (!std::ranges::equal(mixes, mixes_, are_equal)) {
      mixes_.assign(mixes.begin(), mixes.end());
      mix_index_ = trajectory_.index_of(bounds_of(mixes));
    }
    trajectory_.mixes.back() = mix_index_;
  }

  // Notes the joints that corrections of kMix may turn beyond their limits, if each reaches its bound.
  void note_clamps(const Interpreter& at) {
    std::array<std::int64_t, robot::kMaxJoints> bounds_raw{};
    for (const motion::Mix& mix : at.mixes())
      bounds_raw[mix.joint] += std::int64_t{mix.limit} << (fixed::Angle::kFractionBits - 16);
    for (std::size_t j = 0; j < at.targets().size(); ++j) {
      if (bounds_raw[j] == 0) continue;
      const robot::Joint& joint = robot_.model.joints[j];
      const std::int64_t target_raw = at.targets()[j].raw();
      const std::int64_t excess_raw = std::max(target_raw + bounds_raw[j] - joint.upper.raw(),
                                               joint.lower.raw() - (target_raw - bounds_raw[j]));
      if (excess_raw <= 0) continue;
      Trajectory::Clamp& clamp =
          trajectory_.clamps.try_emplace(j, Trajectory::Clamp{trajectory_.ticks(), 0.0}).first->second;
      const double excess_rad =
          std::ldexp(2.0 * std::numbers::pi * static_cast<double>(excess_raw), -fixed::Angle::kFractionBits);
      clamp.excess_rad = std::max(clamp.excess_rad, excess_rad);
    }
  }

  // The visits of this path in one pose.
  struct Visits {
    int count = 0;
    bool holds = false;
    std::size_t last_tick = 0;
    std::size_t first_poll_tick = 0;  // since which the targets have not changed
  };

  ForcedMotion& motion_;
  const simulation::NamedModel& robot_;
  Explored& explored_;
  std::size_t path_;
  Explored::Plan plan_;
  Explored::Plan taken_;
  std::map<Visit, Visits> visits_;
  std::optional<std::size_t> merged_into_;
  std::map<std::size_t, std::size_t> passed_;
  estimation::RobotState state_;
  const motion::Inputs inputs_{.robot = state_};
  bool on_feet_ = true;
  bool stopping_ = false;
  std::size_t moved_tick_ = 0;      // the last one in which a target changed
  std::vector<motion::Mix> mixes_;  // in force
  std::uint32_t mix_index_ = 0;     // of them in the trajectory
  Trajectory trajectory_;
};

}  // namespace

SampledPaths sample_motion(std::span<const std::byte> image, const simulation::NamedModel& robot,
                           std::span<const double> from_rad, const std::stop_token& cancel) {
  ForcedMotion motion(image, robot);
  SampledPaths sampled{.endless = motion.endless()};
  Explored explored;
  std::vector<Leg> legs;
  while (!explored.plans.empty() && !cancel.stop_requested()) {
    const std::size_t path = sampled.paths.size();
    sampled.cut = path == kMaxPaths;
    if (sampled.cut) break;
    Explored::Plan plan = std::move(explored.plans.front());
    explored.plans.pop_front();
    Player player(motion, robot, explored, path, std::move(plan));
    sampled.paths.push_back(player.play(from_rad, cancel));
    legs.push_back({sampled.paths.back().ticks(), player.passed(), player.merged_into()});
  }
  const std::size_t ticks = longest_way(legs, explored.visits.size());
  sampled.longest_s = static_cast<double>(ticks > 0 ? ticks - 1 : 0) * kTick_s;
  return sampled;
}

}  // namespace koboshi::tools
