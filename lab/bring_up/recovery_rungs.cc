#include "lab/bring_up/recovery_rungs.h"

#include <fmt/format.h>

#include <utility>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "lab/bring_up/robot_files.h"
#include "lab/bring_up/standing_pose.h"
#include "lab/bring_up/value_search.h"

namespace koboshi::lab {
namespace {

namespace fs = std::filesystem;

fs::path motion_file(const std::string& name) { return fs::path("motions") / (name + ".yaml"); }

}  // namespace

RecoveryRungs::RecoveryRungs(const BringUpOptions& options, const sim_board::RobotDescription& robot,
                             std::chrono::steady_clock::time_point end,
                             const std::function<void(const std::string&)>& progress)
    : options_(options), robot_(robot), end_(end), progress_(progress) {}

Rung RecoveryRungs::protect_falls(TriedRobot& tried, const simulation::NamedModel& model,
                                  const PlayOptions& play) {
  add_motions({tried, model, play}, {"fall_front", "fall_back", "fall_left", "fall_right"});
  return with_notes(lab::protect_falls(tried, play));
}

RecoveryRungs::Risen RecoveryRungs::rise(const char* name, Lying lying, TriedRobot& tried,
                                         const simulation::NamedModel& model, const PlayOptions& play) {
  const Trial trial{tried, model, play};
  add_motions(trial, {name, "roll_left", "roll_right"});
  Risen risen{.rung = get_up(tried, play, lying)};
  const SearchEnd end(options_.candidates, end_);
  if (!motions_.contains(name) || end.is_reached(0)) {
    risen.rung = with_notes(std::move(risen.rung));
    return risen;
  }
  RecoveryCheck check(options_.robot);
  const auto make = [&](const RecoveryMotion& motion) {
    RobotFiles files = tried.files();
    files[motion_file(name)] = motion.text(kOrigin);
    return tried.with(std::move(files));
  };
  const auto is_enough = [&](const TriedRobot& robot) {
    return get_up(robot, play, lying).result == Rung::Result::kReached;
  };
  const RiseSearch search{.make = make,
                          .is_enough = is_enough,
                          .lying = lying,
                          .play = play,
                          .check = check,
                          .progress = progress_};
  const SearchedMotion found = search_rise(search, rise_starts(trial, name, lying), options_.candidates, end);
  if (found.candidates > 1) {
    risen.candidates = found.candidates;
    tried.files()[std::string(name) + "-search.csv"] = std::string("# ") + kOrigin + "\n" + found.log;
  }
  if (found.motion) {
    risen.rung = with_found(trial, *found.motion, found.candidates, lying, risen.rung);
    note_errors(motions_.at(name), check);
  }
  risen.rung = with_notes(std::move(risen.rung));
  return risen;
}

// A rung with what is noted about its motions.
Rung RecoveryRungs::with_notes(Rung rung) const {
  const bool is_reached = rung.result == Rung::Result::kReached;
  if (is_reached) rung.figure += notes_;
  for (const auto& [name, error] : errors_) (is_reached ? rung.figure : rung.cause) += error;
  return rung;
}

// Notes the first error that the check finds in a motion that has been mended.
void RecoveryRungs::note_errors(const RecoveryMotion& motion, RecoveryCheck& check) {
  errors_.erase(motion.name());
  const std::vector<std::string> errors = check.errors(motion);
  if (!errors.empty())
    errors_[motion.name()] =
        fmt::format("; the check of {} finds {} errors: {}", motion.name(), errors.size(), errors.front());
}

// The motions with which a search for getting up begins.
std::vector<RecoveryMotion> RecoveryRungs::rise_starts(const Trial& trial, const char* name,
                                                       Lying lying) const {
  // Where hands throw the trunk over the feet, a larger robot may need it faster than by its scaled times.
  constexpr double kFaster = 0.75;
  std::vector<RecoveryMotion> starts{motions_.at(name), motions_.at(name).with_times(kFaster)};
  if (lying == Lying::kProne) return starts;
  try {
    const StandingPose pose = standing_pose(trial.tried.values(), trial.model, kOrigin);
    starts.push_back(RecoveryMotion::over_the_side(
        RecoveryMotion::retarget("rise_prone", options_.robot, robot_, pose.joints_deg, 1.0)));
  } catch (const InputError&) {  // a motion of the user's own with other steps, say
  }
  return starts;
}

// Takes a motion that a search has found, unless the robots stood up by the one before and do not by this.
Rung RecoveryRungs::with_found(const Trial& trial, const RecoveryMotion& motion, std::size_t candidates,
                               Lying lying, const Rung& before) {
  std::string& text = trial.tried.files().at(motion_file(motion.name()));
  const std::string kept = text;
  text = motion.text(kOrigin);
  Rung rung = get_up(trial.tried, trial.play, lying);
  if (rung.result != Rung::Result::kReached && before.result == Rung::Result::kReached) {
    text = kept;
    return before;
  }
  motions_.insert_or_assign(motion.name(), motion);
  if (rung.result == Rung::Result::kReached)
    rung.figure += fmt::format(", with a motion that was searched for ({} candidates)", candidates);
  return rung;
}

// Adds motions that the reference robot has to the files, unless the robot has its own.
void RecoveryRungs::add_motions(const Trial& trial, const std::vector<std::string>& names) {
  notes_.clear();
  errors_.clear();
  RecoveryCheck check(options_.robot);
  RobotFiles& files = trial.tried.files();
  const StandingPose pose = standing_pose(trial.tried.values(), trial.model, kOrigin);
  for (const std::string& name : names) {
    const fs::path file = motion_file(name);
    const fs::path own = options_.robot.parent_path() / file;
    if (is_foreign(own)) {
      files[file] = read_text_file(own, "a motion");
      continue;
    }
    if (files.contains(file) && name.starts_with("roll_")) continue;
    RecoveryMotion motion = check.mended(RecoveryMotion::retarget(
        name, options_.reference, robot_, pose.joints_deg, trial.tried.values().time_scale));
    files[file] = motion.text(kOrigin);
    for (const std::string& note : motion.notes()) {
      if (notes_.find(note) == std::string::npos) notes_ += "; " + note;
    }
    note_errors(motion, check);
    motions_.insert_or_assign(name, std::move(motion));
  }
}

}  // namespace koboshi::lab
