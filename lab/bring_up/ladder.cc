#include "lab/bring_up/ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <regex>
#include <set>
#include <utility>

#include "base/file/output_file.h"
#include "base/file/output_folder.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "firmware/motion/roles.h"
#include "firmware/robot/leg.h"
#include "lab/bring_up/recovery_rungs.h"
#include "lab/bring_up/robot_files.h"
#include "lab/bring_up/rungs.h"
#include "lab/bring_up/standing_pose.h"
#include "lab/bring_up/start_values.h"
#include "lab/bring_up/value_search.h"
#include "lab/experiment/files.h"
#include "sim_board/description/load.h"
#include "simulation/assembly/robot_parameters.h"
#include "simulation/model/abilities.h"
#include "simulation/scenario/reader.h"

namespace koboshi::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSearchSeed = 900'000;  // robots of the search; the rungs have others
constexpr std::size_t kSearchRobots = 3;
constexpr double kLowestLevel = 0.2475;  // of a walk's highest speed, at which fastest() begins
constexpr const char* kJournal = "bring-up.json";
constexpr const char* kPage = "bring-up.md";

// The files on which a robot's description depends: its own, and the libraries of servos that it includes.
std::vector<fs::path> robot_files(const fs::path& robot) {
  static const std::regex kLibrary(R"re(<koboshi:servo_types\s+file="([^"]*)")re");
  const std::string text = read_text_file(robot, "a robot");
  std::vector<fs::path> files{robot};
  for (auto match = std::sregex_iterator(text.begin(), text.end(), kLibrary); match != std::sregex_iterator();
       ++match)
    files.push_back(robot.parent_path() / (*match)[1].str());
  return files;
}

// Reads the parameters that are scaled. Throws InputError for a robot that has none with which it walks: each
// rung would fail with a message about the other robot.
simulation::RobotParameters reference_parameters(const fs::path& robot) {
  simulation::RobotParameters parameters = simulation::read_robot_parameters(robot);
  const char* const expected = "a robot that walks, such as robots/koboshi";
  if (parameters.file.empty())
    throw InputError(robot, 0, "no parameters.yaml beside the robot of --reference", expected);
  for (const char* key :
       {"step_time_ms", "step_width_mm", "widest_step_mm", "narrowest_step_mm", "com_height_mm"}) {
    const bool is_given = std::ranges::any_of(parameters.settings, [key](const auto& setting) {
      return setting.name.text == key && setting.value != 0.0;
    });
    if (!is_given)
      throw InputError(parameters.file, 0, std::string("no ") + key + " of the robot of --reference",
                       expected);
  }
  static_cast<void>(simulation::compile_robot_parameters(
      parameters, simulation::load_named_model(sim_board::load_robot(robot)).model));
  return parameters;
}

class Climber {
 public:
  Climber(const BringUpOptions& options, const std::function<void(const std::string&)>& progress)
      : options_(options),
        progress_(progress),
        end_(std::chrono::steady_clock::now() +
             std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                 std::chrono::duration<double>(options.budget_s))),
        folder_(options.robot.parent_path()),
        lock_(folder_.empty() ? "." : folder_),
        robot_(sim_board::load_robot(options.robot)),
        reference_(reference_parameters(options.reference)),
        reference_body_(measure(sim_board::load_robot(options.reference))),
        recovery_(options, robot_, end_, progress_) {}

  BringUpResult run() {
    resume();
    bool going = true;
    for (std::size_t i = 0; i < kRungs.size(); ++i) {
      rung_ = i;
      Rung rung{.name = kRungs[i].name, .figure = {}, .cause = {}};
      rung.cause = going ? missing_for(kRungs[i]) : "after the last rung to try";
      if (rung.cause.empty()) rung = climbed(rung);
      going = going && options_.until != kRungs[i].name;
      result_.rungs.push_back(std::move(rung));
    }
    commit();
    result_.searched = journal_.searched;
    for (const auto& [name, hash] : journal_.hashes) result_.files.push_back(folder_ / name);
    for (const char* name : {kJournal, kPage}) result_.files.push_back(folder_ / name);
    return std::move(result_);
  }

  using Climb = Rung (Climber::*)();
  struct Step {
    const char* name;
    Climb climb;
    const char* needs;  // the rung that must be passed; empty: none
  };
  static const std::array<Step, 12> kRungs;

 private:
  // --- Earlier calls

  // Reads what an earlier call has left, and refuses files that are not its own.
  void resume() {
    for (const char* name : {"parameters.yaml", "motions/stand.yaml", "motions/squat.yaml",
                             "motions/shift.yaml", "go.yaml", kPage})
      static_cast<void>(read_own(folder_ / name));
    std::vector<fs::path> files = robot_files(options_.robot);
    for (const fs::path& file : robot_files(options_.reference)) files.push_back(file);
    files.push_back(reference_.file);
    const std::array<std::string, 1> settings{
        fmt::format("{} {} {} {}", options_.stepper, options_.world, options_.first_seed, options_.seeds)};
    base_hash_ = hash_inputs(files, settings);
    const std::optional<Journal> journal = read_journal(folder_ / kJournal);
    if (journal) {
      for (const auto* hashes : {&journal->hashes, &journal->next_hashes})
        for (const auto& [name, hash] : *hashes) written_[name].insert(hash);
    }
    if (options_.restart || !journal || !journal->is_complete) return;
    for (const auto& [name, hash] : journal->hashes) {
      if (made_at(name) > 0 && is_foreign(folder_ / name)) continue;  // the user's own
      const std::optional<std::string> text = read_own(folder_ / name);
      if (text && hash_of(*text) != hash)
        throw InputError(folder_ / name, 0, "changes since bring-up has written it",
                         "none (to write it again: --restart)");
      if (!text) return;
    }
    before_ = *journal;
  }

  // The rung that makes a file.
  static std::size_t made_at(const fs::path& file) {
    const std::string name = file.stem().string();
    if (name.starts_with("fall_")) return rung_of("falls protected");
    if (name.starts_with("rise_supine")) return rung_of("gets up from the back");
    const bool is_front = name.starts_with("rise_") || name.starts_with("roll_");
    return is_front ? rung_of("gets up from the front") : 0;
  }
  // Returns whether a file is made below a rung, which depends on it.
  static bool is_input_of(std::string_view rung, const fs::path& file) {
    return file != "go.yaml" && file.extension() != ".csv" && rung_of(rung) > made_at(file);
  }

  // Why a rung cannot be tried; empty if it can.
  std::string missing_for(const Step& step) const {
    if (*step.needs == '\0') return {};
    const Rung& needed = result_.rungs[rung_of(step.needs)];
    if (needed.is_passed()) return {};
    return fmt::format("needs the rung \"{}\", which {}", needed.name,
                       needed.result == Rung::Result::kFailed ? "failed" : "was not tried");
  }

  // The hash of what a rung depends on. The first one makes the files from the robot.
  std::string inputs_of(const char* rung) const {
    std::string text = base_hash_ + rung;
    if (current_) {
      for (const auto& [name, content] : current_->files()) {
        if (is_input_of(rung, name)) text += name.string() + content;
      }
    }
    // Motions of the user's own, which the rungs of falling and getting up play as they are.
    for (const std::string_view name : motion::kMotionNames) {
      const fs::path file = folder_ / "motions" / (std::string(name) + ".yaml");
      if (rung_of(rung) >= made_at(file) && is_foreign(file)) text += read_text_file(file, "a motion");
    }
    return hash_of(text);
  }

  // Takes the rung from an earlier call, or climbs it and writes the files.
  Rung climbed(const Rung& untried) {
    const std::string inputs = inputs_of(untried.name.c_str());
    const JournalEntry* known = before_ ? before_->find(untried.name) : nullptr;
    const bool is_same = known != nullptr && known->inputs == inputs;
    const std::string place = fmt::format("{} of {}, {}", rung_ + 1, kRungs.size(), untried.name);
    if (is_same && known->rung.is_passed() && take_over(*known)) {
      progress_(fmt::format("{}: as before, {}", place, known->rung.text()));
      return known->rung;
    }
    progress_(place);
    Rung rung = untried;
    try {
      rung = (this->*kRungs[rung_].climb)();
      rung.name = untried.name;
    } catch (const InputError& error) {
      if (error.file().string().starts_with("--")) throw;  // an option, which no robot is to blame for
      rung.result = Rung::Result::kFailed;
      rung.cause = error.what();
    }
    // The search may have changed the files, and with them the inputs.
    journal_.entries.push_back({rung, rung_ == 0 ? inputs : inputs_of(untried.name.c_str())});
    commit();
    progress_(fmt::format("{}: {}", place, rung.text()));
    return rung;
  }

  bool take_over(const JournalEntry& known) {
    if (rung_ == 0) {
      model_ = simulation::load_named_model(robot_);
      journal_.factors = before_->factors;
      journal_.searched = before_->searched;
      journal_.walked_m_per_s = before_->walked_m_per_s;
      current_ = make(journal_.factors);
      for (const auto& [name, text] : current_->files()) {
        const auto hash = before_->hashes.find(name.string());
        if (name != "go.yaml" && (hash == before_->hashes.end() || hash->second != hash_of(text))) {
          journal_ = {};
          before_.reset();
          return false;
        }
      }
    }
    // Files that this rung has made in the earlier call.
    for (const auto& [name, hash] : before_->hashes) {
      std::error_code missing;
      if (rung_ > 0 && made_at(name) == rung_ && fs::exists(folder_ / name, missing))
        current_->files()[name] = read_text_file(folder_ / name, "a file");
    }
    journal_.entries.push_back(known);
    return true;
  }

  // --- Files

  std::string go_text(const StartValues& values, const std::string& joints_text,
                      const RobotFiles& files) const {
    // Less than the highest speed, at which some robots fall with other seeds than those of the ladder: of an
    // imported one 1 of 5, and none at this share (28 November 2026).
    constexpr double kShare = 0.7;
    const double forward_m_per_s = journal_.walked_m_per_s
                                       ? kShare * *journal_.walked_m_per_s
                                       : 0.3 * values.value("highest_velocity_forward_mm_per_s") / 1e3;
    std::string motions;
    for (const std::string& name : motion_names(files)) motions += (motions.empty() ? "" : ", ") + name;
    return fmt::format(
        "# {}: stands, and walks forward.\nversion: 1\nrobot: robot.sdf\nmotions: [{}]\nduration_s: "
        "15\nseed: 1\ninitial:\n  held_until_s: 3.5\n  joints_deg: {{{}}}\ncommands:\n  - {{at_s: 2, "
        "enable: true}}\n  - {{at_s: 5, walk: {{forward_m_per_s: {:.3f}}}}}\n  - {{at_s: 12, stop: true}}\n",
        kOrigin, motions, joints_text, forward_m_per_s);
  }

  std::shared_ptr<TriedRobot> make(const StartFactors& factors) const {
    StartValues values = scaled_values(reference_, reference_body_, robot_, *model_, factors);
    const StandingPose pose = standing_pose(values, *model_, kOrigin);
    RobotFiles files{{"parameters.yaml", parameters_text(values, kOrigin)},
                     {"motions/stand.yaml", pose.stand_text}};
    if (!pose.squat_text.empty()) files["motions/squat.yaml"] = pose.squat_text;
    if (!pose.shift_text.empty()) files["motions/shift.yaml"] = pose.shift_text;
    values.unreached = pose.unreached;
    files["go.yaml"] = go_text(values, pose.joints_text, files);
    return std::make_shared<TriedRobot>(std::move(files), std::move(values), pose.step_s, options_.robot,
                                        scratch_);
  }

  void write(const fs::path& name, const std::string& text) {
    const fs::path file = folder_ / name;
    std::error_code missing;
    if (fs::exists(file, missing)) {
      const std::string before = read_text_file(file, "a file");
      if (before == text) return;
      if (name != kJournal && name != kPage) keep_edited(name, before);
    }
    fs::create_directories(file.parent_path());
    write_whole_file(file, text);
    written_[name.string()] = {hash_of(text)};
  }

  // Keeps a copy of a file that somebody has changed since bring-up has written it, or may have changed,
  // where there is no journal. A call that was killed while it wrote has left files of before and of after
  // it, and its journal knows both.
  void keep_edited(const fs::path& name, const std::string& text) {
    const auto known = written_.find(name.string());
    if (known != written_.end() && known->second.contains(hash_of(text))) return;
    fs::path copy = name;
    copy += ".bak";
    for (int number = 2; fs::exists(folder_ / copy); ++number)
      copy = name.string() + fmt::format(".bak{}", number);
    write_whole_file(folder_ / copy, text);
    progress_(fmt::format("{}: may have been changed since bring-up has written it; kept as {}",
                          name.string(), copy.string()));
  }

  // Writes the files of the present robot. A program that ends in between leaves an incomplete journal, and
  // the next call begins anew.
  void commit() {
    if (current_) {
      const StandingPose pose = standing_pose(current_->values(), *model_, kOrigin);
      current_->files()["go.yaml"] = go_text(current_->values(), pose.joints_text, current_->files());
    }
    Journal next = journal_;
    next.hashes.clear();
    const RobotFiles files = current_ ? current_->files() : RobotFiles();
    for (const auto& [name, text] : files) next.hashes[name.string()] = hash_of(text);
    if (next.hashes != journal_.hashes) {
      Journal begun = journal_;
      begun.is_complete = false;
      begun.next_hashes = next.hashes;
      // Files of an earlier call may still be there.
      for (const auto& [name, hashes] : written_)
        if (!begun.hashes.contains(name) && !hashes.empty()) begun.hashes[name] = *hashes.begin();
      write(kJournal, journal_text(begun));
    }
    for (const auto& [name, text] : files) write(name, text);
    journal_ = std::move(next);
    journal_.is_complete = true;
    write(kPage, page());
    write(kJournal, journal_text(journal_));
  }

  // --- Rungs

  PlayOptions play_options() const {
    return {.stepper = options_.stepper,
            .world = options_.world,
            .first_seed = options_.first_seed,
            .seeds = options_.seeds,
            .jobs = options_.jobs,
            .go_on = options_.go_on};
  }

  Rung load() {
    model_ = simulation::load_named_model(robot_);
    current_ = make({});
    std::string lost;
    for (const simulation::LostAbility& ability : simulation::find_lost_abilities(model_->model))
      lost += (lost.empty() ? "; without " : ", ") + ability.name;
    const BodyMeasures body = measure(robot_);
    return {.name = {},
            .result = Rung::Result::kReached,
            .figure = fmt::format(
                "{} joints, {:.2f} kg, legs of {:.0f} mm, the centre of mass {:.0f} mm above the "
                "soles, {:.0f} mm in the standing pose with {:.0f} % of the legs' length; a "
                "leg's servos are {:.1f} times as stiff as gravity tips it{}",
                robot_.joints.size(), robot_.total_mass_kg(), kMmPerM * body.leg_m, kMmPerM * body.com_m,
                kMmPerM * current_->values().com_height_m, 100.0 * current_->values().leg_use,
                body.pitch_stiffness_Nm_per_rad / (body.weight_N * body.com_m), lost),
            .cause = {}};
  }

  Rung hang() { return lab::hang(*current_, play_options()); }
  Rung stand() { return lab::stand(*current_, play_options()); }
  Rung shift() { return lab::shift_weight(*current_, play_options()); }
  Rung squat() { return lab::squat(*current_, play_options()); }

  Rung march() {
    Rung rung = lab::march(*current_, play_options());
    if (rung.result == Rung::Result::kReached || !searched(forward_walk(), 0.0)) return rung;
    return lab::march(*current_, play_options());
  }

  Rung walk() { return walk_by(forward_walk(), 0.5); }
  Rung sidestep() { return walk_by(sideways_walk(), 0.0); }
  Rung turn() {
    // As the firmware's ability of this name (simulation/model/abilities.h).
    if (!robot::can_turn(model_->model))
      return {.name = {},
              .result = Rung::Result::kImpossible,
              .figure = {},
              .cause = "the hips do not turn the feet against each other"};
    return walk_by(turning_walk(), 0.0);
  }

  // Climbs a walk. Below this share of the highest speed a search tries to reach half of it, or the lowest
  // level if the robots do not walk at all. Its result stays only if the robots then walk faster, or as fast
  // and make more of it good.
  Rung walk_by(const Walk& walk, double wanted_share) {
    constexpr int kMostSearches = 2;  // for the lowest level, then for half of the highest speed
    const bool is_forward = rung_of("walks forward") == rung_;
    WalkRung best = fastest(*current_, play_options(), walk);
    if (is_forward) journal_.walked_m_per_s = best.speed;
    for (int i = 0; i < kMostSearches; ++i) {
      const double highest = walk.highest(current_->values());
      if (best.speed && *best.speed >= wanted_share * highest) break;
      const Kept kept{current_, journal_, result_.rungs};
      if (!searched(walk, best.speed ? wanted_share * highest : kLowestLevel * highest)) break;
      WalkRung after = fastest(*current_, play_options(), walk);
      if (!is_better(after, best)) {
        progress_("the robots walk no better with the values of the search: they are dropped");
        put_back(kept);
        break;
      }
      best = std::move(after);
      if (is_forward) journal_.walked_m_per_s = best.speed;
    }
    return best.rung;
  }

  Rung fall() { return recovery_.protect_falls(*current_, *model_, play_options()); }
  Rung rise_prone() { return rise("rise_prone", Lying::kProne); }
  Rung rise_supine() { return rise("rise_supine", Lying::kSupine); }
  Rung rise(const char* name, Lying lying) {
    RecoveryRungs::Risen risen = recovery_.rise(name, lying, *current_, *model_, play_options());
    journal_.searched += risen.candidates;
    return std::move(risen.rung);
  }

  static bool is_better(const WalkRung& after, const WalkRung& before) {
    if (!after.speed || !before.speed) return after.speed.has_value();
    // Levels are an eighth of the limit, which no factor changes.
    if (*after.speed != *before.speed) return *after.speed > *before.speed;
    return after.made_good > before.made_good;
  }

  static std::size_t rung_of(std::string_view name) {
    return static_cast<std::size_t>(
        std::ranges::find_if(kRungs, [&](const Step& step) { return step.name == name; }) - kRungs.begin());
  }

  // --- Search

  struct Kept {
    std::shared_ptr<TriedRobot> robot;
    Journal journal;
    std::vector<Rung> rungs;
  };

  // As before a search, but for the number of its candidates.
  void put_back(const Kept& kept) {
    const std::size_t candidates = journal_.searched;
    current_ = kept.robot;
    journal_ = kept.journal;
    journal_.searched = candidates;
    result_.rungs = kept.rungs;
  }

  // Plays a rung between the first one and the turns, without a search.
  WalkRung measure_rung(std::size_t rung, const TriedRobot& robot) const {
    using Measure = Rung (*)(const TriedRobot&, const PlayOptions&);
    constexpr std::array<Measure, 5> kMeasures{lab::hang, lab::stand, lab::shift_weight, lab::squat,
                                               lab::march};
    if (rung <= kMeasures.size()) return {.rung = kMeasures[rung - 1](robot, play_options()), .speed = {}};
    return fastest(robot, play_options(),
                   rung == rung_of("walks forward") ? forward_walk() : sideways_walk());
  }

  // Returns whether a robot reaches the rungs below the present one that have been passed. `measured`
  // receives all of them, from the second one on, with those that failed and may now be reached.
  bool lower_rungs(const TriedRobot& robot, std::vector<WalkRung>* measured = nullptr) const {
    for (std::size_t i = 1; i < rung_; ++i) {
      const bool was_passed = result_.rungs[i].is_passed();
      const bool is_forward = i == rung_of("walks forward");
      if (is_forward && was_passed &&
          !walks_at(robot, play_options(), forward_walk(), *journal_.walked_m_per_s))
        return false;
      if (measured == nullptr && (is_forward || !was_passed)) continue;
      WalkRung rung = measure_rung(i, robot);
      if (was_passed && !rung.rung.is_passed()) return false;
      if (measured != nullptr) measured->push_back(std::move(rung));
    }
    return true;
  }

  // Searches for better values and, if there are any, takes them and measures the rungs below again.
  bool searched(const Walk& walk, double speed) {
    PlayOptions play = play_options();
    play.first_seed = kSearchSeed;
    play.seeds = std::min(kSearchRobots, options_.seeds);
    const ValueSearch search{.make = [this](const StartFactors& factors) { return make(factors); },
                             .lower_rungs = [this](const TriedRobot& robot) { return lower_rungs(robot); },
                             .walk = walk,
                             .speed = speed,
                             .play = play,
                             .progress = progress_};
    const SearchedValues found = search_values(search, journal_.factors, *current_,
                                               SearchEnd(options_.candidates, end_), journal_.searched);
    journal_.searched += found.candidates;
    if (!found.robot) return false;
    std::vector<WalkRung> measured;
    if (!lower_rungs(*found.robot, &measured)) return false;
    current_ = found.robot;
    journal_.factors = found.factors;
    for (std::size_t i = 0; i < measured.size(); ++i) {
      const char* name = kRungs[i + 1].name;
      Rung& rung = measured[i].rung;
      rung.name = name;
      journal_.entries[i + 1] = {rung, inputs_of(name)};
      result_.rungs[i + 1] = rung;
      if (i + 1 == rung_of("walks forward")) journal_.walked_m_per_s = measured[i].speed;
    }
    return true;
  }

  std::string page() const {
    std::string text = fmt::format(
        "# {}\n\n{}, with seeds {} to {} in worlds `{}`, stepper `{}`.\n\n| rung | reached | figure, or "
        "cause |\n| --- | --- | --- |\n",
        model_ ? model_->robot : robot_.name, kOrigin, options_.first_seed,
        options_.first_seed + options_.seeds - 1, options_.world, options_.stepper);
    for (const Step& step : kRungs) {
      const JournalEntry* entry = journal_.find(step.name);
      const auto skipped = std::ranges::find(result_.rungs, step.name, &Rung::name);
      Rung rung{.name = step.name, .figure = {}, .cause = {}};
      if (entry != nullptr) {
        rung = entry->rung;
      } else if (skipped != result_.rungs.end()) {
        rung = *skipped;
      }
      text += fmt::format("| {} | {} | {} |\n", step.name, mark_of(rung.result), rung.text());
    }
    text += fmt::format("\nThe start values are scaled from {}", reference_.robot.text);
    if (journal_.searched > 0)
      text += fmt::format("; a search over {} candidates gave: {}", journal_.searched,
                          factors_text(journal_.factors));
    return text + ".\n\n    koboshi run go.yaml\n";
  }

  const BringUpOptions& options_;
  const std::function<void(const std::string&)>& progress_;
  const std::chrono::steady_clock::time_point end_;
  const fs::path folder_;
  const FolderLock lock_;
  const TemporaryFolder scratch_;
  const sim_board::RobotDescription robot_;
  const simulation::RobotParameters reference_;
  const BodyMeasures reference_body_;
  std::string base_hash_;
  std::map<std::string, std::set<std::string>> written_;  // hashes of the files as bring-up has written them
  std::optional<Journal> before_;                         // of an earlier call, as long as it applies
  Journal journal_;
  std::size_t rung_ = 0;
  std::optional<simulation::NamedModel> model_;
  std::shared_ptr<TriedRobot> current_;
  RecoveryRungs recovery_;
  BringUpResult result_;
};

const std::array<Climber::Step, 12> Climber::kRungs{
    {{"loads", &Climber::load, ""},
     {"hangs", &Climber::hang, "loads"},
     {"stands", &Climber::stand, "hangs"},
     {"shifts its weight", &Climber::shift, "stands"},
     {"squats", &Climber::squat, "stands"},
     {"steps on the spot", &Climber::march, "stands"},
     {"walks forward", &Climber::walk, "stands"},
     {"walks sideways", &Climber::sidestep, "stands"},
     {"turns", &Climber::turn, "stands"},
     {"falls protected", &Climber::fall, "stands"},
     {"gets up from the front", &Climber::rise_prone, "stands"},
     {"gets up from the back", &Climber::rise_supine, "stands"}}};

}  // namespace

BringUpResult bring_up(const BringUpOptions& options,
                       const std::function<void(const std::string&)>& progress) {
  return Climber(options, progress).run();
}

std::vector<std::string> rung_names() {
  std::vector<std::string> names;
  for (const auto& step : Climber::kRungs) names.emplace_back(step.name);
  return names;
}

std::string ladder_text(const BringUpResult& result) {
  std::string text;
  for (const Rung& rung : result.rungs) {
    text += fmt::format("{:24} {:4} {}\n", rung.name, mark_of(rung.result), rung.text());
  }
  return text;
}

}  // namespace koboshi::lab
