#include "tools/motion_files/flatten.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "base/text/error.h"
#include "base/text/text.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/motion_language/compile/zmp_path.h"
#include "tools/motion_files/format/lines.h"

namespace koboshi::tools {
namespace {

using simulation::StepSource;
using Kind = StepSource::Kind;

constexpr std::size_t kMostKeyFrames = 10'000;
// By interpolation, from rest to rest.
constexpr std::array<double, 4> kPeakToMean{1.0, 15.0 / 8.0, 3.0 / 2.0, 3.0 / 2.0};
constexpr double kSpeedUnit_rad_per_s = 2.0 * std::numbers::pi / (1 << 24);

class Flattener {
 public:
  Flattener(const simulation::MotionSource& source, const simulation::NamedModel& robot)
      : source_(source), robot_(robot), last_(robot.joint_names.size()) {
    for (const std::string& name : robot.joint_names) motion_.joints.push_back({.name = name});
    motion_.name = source.name;
  }

  ForeignMotion run() {
    walk(source_.steps);
    if (frames_.empty())
      throw InputError(source_.file, 0, "a motion without a step that takes time", "at least one");
    if (linear_ > 0 && smooth_ > 0)
      note(0, "some of its moves are linear and some smooth; the file cannot say which");
    motion_.is_smooth = smooth_ > linear_;
    motion_.sections.push_back({.frames = std::move(frames_)});
    return std::move(motion_);
  }

 private:
  void note(int line, const std::string& text) {
    if (noted_.insert(text).second)
      motion_.notes.push_back({line > 0 ? line_place(static_cast<std::size_t>(line)) : "motion", text});
  }

  [[noreturn]] void refuse(const StepSource& step, const std::string& found) const {
    throw InputError(source_.file, step.place.line, found,
                     "a motion whose steps are the same each time it is played");
  }

  void walk(const std::vector<StepSource>& steps) {
    for (const StepSource& step : steps) {
      if (ended_) return;
      visit(step);
    }
  }

  void visit(const StepSource& step) {
    switch (step.kind) {
      case Kind::kMove:
        return move(step);
      case Kind::kWait:
        return wait(step.time_us, step.place.line);
      case Kind::kLoop:
        return loop(step);
      case Kind::kStiffness:
        return stiffness(step.stiffness, step.place.line, limp_);
      case Kind::kGain:
        return note(step.place.line, "gains of the position loops are left out");
      case Kind::kCall:
        return call(step);
      case Kind::kEnd:
        ended_ = true;
        return;
      case Kind::kAwait:
      case Kind::kIf:
      case Kind::kJump:
      case Kind::kFail:
        refuse(step, "a step that depends on a condition, or a jump");
      case Kind::kSet:
        return note(step.place.line, "variables are left out");
      case Kind::kExpect:
        return note(step.place.line, "an attitude that is expected is left out");
      case Kind::kMix:
        return note(step.place.line, "corrections from sensors (mix) are left out");
      case Kind::kLean:
        lean_ = *step.lean;
        return;
      case Kind::kReturn:
      case Kind::kLabel:
        return;
    }
  }

  void call(const StepSource& step) {
    const auto routine =
        std::ranges::find_if(source_.routines, [&](const auto& own) { return own.name == step.label; });
    if (routine == source_.routines.end()) refuse(step, "the unknown routine " + one_line(step.label));
    // A return in the middle would have to end the routine only.
    for (std::size_t i = 0; i < routine->steps.size(); ++i) {
      if (routine->steps[i].kind == Kind::kReturn) break;
      if (ended_) return;
      visit(routine->steps[i]);
    }
  }

  void loop(const StepSource& step) {
    if (step.loop != StepSource::LoopKind::kTimes && step.loop != StepSource::LoopKind::kUntilStopped)
      refuse(step, "a loop that depends on a condition");
    const bool endless = step.loop == StepSource::LoopKind::kUntilStopped || step.times == 0;
    if (endless) note(step.place.line, "a loop that repeats until it is stopped is played once");
    const std::size_t before = frames_.size();
    for (int i = 0; i < (endless ? 1 : static_cast<int>(step.times)) && !ended_; ++i) {
      walk(step.body);
      if (frames_.size() == before && i > 0) return;  // nothing that takes time
    }
  }

  void stiffness(const std::vector<motion::Stiffness>& changes, int line, std::set<std::size_t>& limp) {
    for (const motion::Stiffness& change : changes) {
      if (change.percent != 0 && change.percent != motion::Stiffness::kFull)
        note(line, "a stiffness between 0 and 100 percent is left out");
      for (std::size_t joint = 0; joint < last_.size(); ++joint) {
        if ((change.joints >> joint & 1U) == 0) continue;
        if (change.percent == 0) {
          limp.insert(joint);
        } else {
          limp.erase(joint);
        }
      }
    }
  }

  void wait(std::int64_t time_us, int line) {
    if (!frames_.empty() &&
        std::vector<std::size_t>(limp_.begin(), limp_.end()) == frames_.back().without_torque) {
      frames_.back().pause_us += time_us;
      return;
    }
    add({.place = line_place(static_cast<std::size_t>(std::max(line, 1))),
         .move_us = time_us,
         .values = std::vector<ForeignValue>(last_.size())},
        limp_, line);
  }

  void move(const StepSource& step) {
    const simulation::PoseSource& pose = source_.poses[step.pose];
    if (!step.windows.empty()) return move_by_parts(step, pose);
    ForeignFrame frame{.place = line_place(static_cast<std::size_t>(std::max(step.place.line, 1)))};
    frame.values.resize(last_.size());
    frame.move_us = step.speed_raw != 0 ? time_by_speed_us(step, pose)
                    : step.at_least     ? std::max<std::int64_t>(step.time_us, fastest_us(step, pose))
                                        : std::int64_t{step.time_us};
    frame.pause_us = step.pause_us;
    for (std::size_t joint = 0; joint < last_.size(); ++joint) {
      if (!pose.angles[joint]) continue;
      frame.values[joint] = fixed::to_double(*pose.angles[joint]);
      last_[joint] = frame.values[joint];
    }
    note_settings(step);
    (step.interpolation == motion::Interpolation::kLinear ? linear_ : smooth_) += 1;
    std::set<std::size_t> limp = limp_;
    stiffness(step.stiffness, step.place.line, limp);
    frame.lean = step.lean;
    add(std::move(frame), limp, step.place.line);
  }

  void note_settings(const StepSource& step) {
    if (!step.mix.empty()) note(step.place.line, "corrections from sensors (mix) are left out");
    if (!step.gain.empty()) note(step.place.line, "gains of the position loops are left out");
  }

  // A key frame at each beginning and end of a joint's own time.
  void move_by_parts(const StepSource& step, const simulation::PoseSource& pose) {
    std::set<std::uint16_t> keys{motion::Window::kWhole};
    for (const motion::Window& window : step.windows) keys.insert({window.start, window.end});
    keys.erase(0);
    note_settings(step);
    (step.interpolation == motion::Interpolation::kLinear ? linear_ : smooth_) += 1;
    std::set<std::size_t> limp = limp_;
    stiffness(step.stiffness, step.place.line, limp);
    const std::vector<std::optional<double>> from = last_;
    std::int64_t time_us = 0;
    for (const std::uint16_t key : keys) {
      ForeignFrame frame{.place = line_place(static_cast<std::size_t>(std::max(step.place.line, 1)))};
      frame.values.resize(last_.size());
      const std::int64_t until_us = std::int64_t{step.time_us} * key / motion::Window::kWhole;
      frame.move_us = until_us - time_us;
      time_us = until_us;
      if (key == motion::Window::kWhole) frame.pause_us = step.pause_us;
      frame.lean = step.lean;
      for (std::size_t joint = 0; joint < last_.size(); ++joint) {
        if (!pose.angles[joint]) continue;
        const double share = share_of_way(step, joint, key);
        const double to = fixed::to_double(*pose.angles[joint]);
        if (share < 1.0 && !from[joint]) continue;  // nobody knows where it is
        frame.values[joint] = share < 1.0 ? std::lerp(*from[joint], to, share) : to;
        last_[joint] = frame.values[joint];
      }
      add(std::move(frame), limp, step.place.line);
    }
  }

  // The share of its way that a joint has covered at this share of the move's time, 2^-12, if it turns
  // evenly.
  static double share_of_way(const StepSource& step, std::size_t joint, std::uint16_t time) {
    const motion::Window part = simulation::window_of(step, joint);
    return std::clamp((static_cast<double>(time) - part.start) / (part.end - part.start), 0.0, 1.0);
  }

  std::int64_t time_by_speed_us(const StepSource& step, const simulation::PoseSource& pose) const {
    double farthest_rad = 0.0;
    for (std::size_t joint = 0; joint < last_.size(); ++joint) {
      if (!pose.angles[joint]) continue;
      if (!last_[joint]) refuse(step, "a move by speed whose beginning is unknown");
      farthest_rad = std::max(farthest_rad, std::abs(fixed::to_double(*pose.angles[joint]) - *last_[joint]));
    }
    const double speed =
        step.speed_raw * kSpeedUnit_rad_per_s / kPeakToMean.at(static_cast<std::size_t>(step.interpolation));
    return std::max<std::int64_t>(1'000, std::llround(1e6 * farthest_rad / speed));
  }

  // The time in which no joint exceeds its speed limit; joints whose beginning is unknown do not count.
  std::int64_t fastest_us(const StepSource& step, const simulation::PoseSource& pose) const {
    double longest_s = 0.0;
    for (std::size_t joint = 0; joint < last_.size(); ++joint) {
      if (!pose.angles[joint] || !last_[joint]) continue;
      const double way_rad = std::abs(fixed::to_double(*pose.angles[joint]) - *last_[joint]);
      longest_s = std::max(longest_s, way_rad / fixed::to_double(robot_.model.joints[joint].max_speed));
    }
    return std::llround(1e6 * longest_s * kPeakToMean.at(static_cast<std::size_t>(step.interpolation)));
  }

  void add(ForeignFrame frame, const std::set<std::size_t>& limp, int line) {
    if (frames_.size() == kMostKeyFrames)
      throw InputError(source_.file, line, "more than 10000 key frames with all repetitions", "fewer");
    frame.without_torque.assign(limp.begin(), limp.end());
    if (!frame.lean) frame.lean = lean_;
    if (frame.lean->pitch == 0 && frame.lean->roll == 0) frame.lean.reset();
    frames_.push_back(std::move(frame));
  }

  const simulation::MotionSource& source_;
  const simulation::NamedModel& robot_;
  std::vector<ForeignValue> last_;  // by joint, where it is known
  motion::LeanDeclaration lean_;    // by the last step of its own
  std::set<std::size_t> limp_;
  std::set<std::string> noted_;
  std::vector<ForeignFrame> frames_;
  ForeignMotion motion_;
  std::size_t linear_ = 0;
  std::size_t smooth_ = 0;
  bool ended_ = false;
};

}  // namespace

ForeignMotion flatten_motion(const simulation::MotionSource& source, const simulation::NamedModel& robot) {
  simulation::Diagnostics messages(source.file);
  const simulation::MotionSource divided = simulation::with_zmp_paths(source, robot, messages);
  messages.throw_errors();
  return Flattener(divided, robot).run();
}

}  // namespace koboshi::tools
