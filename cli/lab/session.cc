#include "cli/lab/session.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>

#include "base/file/output_file.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "cli/options.h"
#include "lab/cluster/job_file.h"
#include "lab/cluster/shard_run.h"
#include "lab/experiment/files.h"
#include "lab/trial/trial_recordings.h"
#include "sim_board/world/options.h"
#include "simulation/batch/parallel.h"
#include "simulation/disturbance/world_ranges.h"
#include "simulation/record/summary.h"
#include "simulation/scenario/paths.h"

namespace koboshi::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLogName = "trials.jsonl";

// Throws if the folder holds anything but an earlier experiment.
void check_folder(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) throw InputError(folder, 0, "a file", "a folder for the results");
  if (fs::is_empty(folder) || fs::exists(folder / kLogName)) return;
  throw InputError(folder, 0, "a folder with other files",
                   "a new or empty folder, or one of an earlier experiment");
}

bool is_lost(const std::vector<lab::Metric>& metrics, const lab::Record& record) {
  for (std::size_t i = 0; i < metrics.size(); ++i)
    if (metrics[i].is_loss && record.values[i].value_or(0.0) != 0.0) return true;
  return !record.error.empty();
}

// The same experiment, which keeps a recording of each lost trial in the folder: CELL-SEED.mcap.
lab::Experiment recorded(lab::Experiment experiment, const fs::path& folder) {
  experiment.play = [play = experiment.play, metrics = experiment.metrics, cells = experiment.cells, folder](
                        std::size_t cell, std::uint64_t seed) {
    lab::TrialRecordings recordings(folder / fmt::format("{}-{}", cells[cell].name, seed));
    lab::Record record = play(cell, seed);
    if (is_lost(metrics, record)) recordings.keep();
    return record;
  };
  return experiment;
}

// With --shards plan, status or merge, and with --shard.
lab::JobFile job_of(const lab::Experiment& experiment, const SessionOptions& session,
                    const Invocation& invocation) {
  return {lab::job_command(invocation.arguments), fs::current_path(), session.shards.count(session.out),
          experiment.inputs};
}

// Plays a shard and prints how far it is.
void play_one_shard(const lab::Experiment& experiment, const SessionOptions& session) {
  const lab::Shard shard = session.shards.shard.value();
  const ProgressLine line;
  lab::ShardOptions options{
      .jobs = session.jobs,
      .refresh_after = std::chrono::duration<double>(0.5 * static_cast<double>(shard.count))};
  if (session.budget_s > 0.0) options.budget = std::chrono::duration<double>(session.budget_s);
  options.progress = [&line](const lab::ShardProgress& progress) {
    line.show(fmt::format("{} of {} trials", progress.finished, progress.finished + progress.remaining));
  };
  const lab::ShardProgress progress =
      lab::play_shard(session.record_lost.empty() ? experiment : recorded(experiment, session.record_lost),
                      session.out, shard, options);
  fmt::print("shard {} of {}: {} trials{}\n", shard.number, shard.count, progress.finished,
             progress.is_complete() ? "" : fmt::format(", {} to go", progress.remaining));
}

std::vector<lab::ShardProgress> progress_of_shards(const lab::Experiment& experiment,
                                                   const SessionOptions& session, std::size_t count) {
  lab::ShardedTrials trials(experiment, session.out, count);
  trials.refresh();
  std::vector<lab::ShardProgress> progress;
  for (std::size_t i = 1; i <= count; ++i) progress.push_back(trials.progress(i));
  return progress;
}

lab::ExperimentResult play(const lab::Experiment& experiment, const SessionOptions& session) {
  check_folder(session.out);
  fs::create_directories(session.out);
  const ProgressLine line;
  lab::ExperimentOptions options{.log = session.out / kLogName, .jobs = session.jobs};
  if (session.budget_s > 0.0) options.budget = std::chrono::duration<double>(session.budget_s);
  options.progress = [&line](const lab::ExperimentProgress& progress) {
    const double played_min = progress.wall_s / 60.0;
    const double share = static_cast<double>(progress.done) / static_cast<double>(progress.total);
    line.show(fmt::format("{} of {} trials, {:.1f} min, at most {:.1f} min to go", progress.done,
                          progress.total, played_min, played_min * (1.0 / share - 1.0)));
  };
  return lab::play_experiment(
      session.record_lost.empty() ? experiment : recorded(experiment, session.record_lost), options);
}

// Draws the figure in the folder of the results and copies it beside the page. Returns Markdown that shows it
// there; empty without a page or a figure.
std::string draw_figure(const tools::PlaneFigure& figure, const SessionOptions& session) {
  try {
    tools::draw(figure, session.out / "figure");
  } catch (const tools::PlotError& error) {
    print_error("koboshi: no figure: {}\n", error.what());
    return {};
  }
  if (session.page.empty()) return {};
  const std::string image = session.section + ".png";
  fs::copy_file(session.out / "figure.png", session.page.parent_path() / image,
                fs::copy_options::overwrite_existing);
  return "![" + figure.title + "](" + image + ")\n";
}

// Likewise for the figures of small multiples.
std::string draw_grid(const lab::NamedGrid& named, const SessionOptions& session) {
  try {
    tools::draw(named.grid, session.out / named.name);
  } catch (const tools::PlotError& error) {
    print_error("koboshi: no figure: {}\n", error.what());
    return {};
  }
  if (session.page.empty()) return {};
  const std::string image = session.section + "-" + named.name + ".png";
  fs::copy_file(session.out / (named.name + ".png"), session.page.parent_path() / image,
                fs::copy_options::overwrite_existing);
  return "![" + named.grid.title + "](" + image + ")\n";
}

// The table with the command that made it, the remarks and the figures, as a section of the page.
void write_page(const lab::Experiment& experiment, const SessionOptions& session,
                const std::string& command_line, const std::string& table, const std::string& remarks,
                const std::string& figures) {
  std::string text = fmt::format("\n```console not-run\n$ {}\n```\n\n{}", command_line, table);
  if (!remarks.empty()) text += "\n```\n" + remarks + "```\n";
  if (!figures.empty()) text += "\n" + figures;
  lab::write_section(session.page, experiment.title, session.section, text + "\n");
}

}  // namespace

void add_first_seed_option(CLI::App& command, std::uint64_t& seed, const std::string& help) {
  add_number(command, "--first-seed", seed, 0, 9'000'000'000'000'000, help);
}

void check_output_file(const fs::path& file) {
  if (file.empty()) return;
  if (fs::is_directory(file)) throw InputError(file, 0, "a folder", "a file to write");
  const fs::path folder = fs::absolute(file).parent_path();
  if (!fs::is_directory(folder)) throw InputError(file, 0, "no folder to write it in", "one that exists");
}

void add_stepper_option(CLI::App& command, std::string& stepper, const std::string& help) {
  command.add_option("--stepper", stepper, help)->check(CLI::IsMember(sim_board::stepper_names()));
}

void add_jobs_option(CLI::App& command, std::size_t& jobs) {
  jobs = simulation::core_count();
  command.add_option("--jobs", jobs, "Trials at a time (default: the number of cores)")
      ->check(CLI::Range(1, 1024));
}

void add_session_options(CLI::App& command, lab::ExperimentSetup& setup, SessionOptions& session) {
  add_number(command, "--seeds", setup.seeds, 1, 1'000'000, "Seeds that each cell is played with");
  add_first_seed_option(command, setup.first_seed, "The first of them");
  add_stepper_option(command, session.stepper, "Stepper of the physics in all cells, as in koboshi run");
  command.add_option("--set", session.sets, "Override a key of the scenario in all cells; may be repeated")
      ->allow_extra_args(false);
  add_robot_option(command, session.robot);
  command.add_option("--world", setup.world, "Differences between the robots and floors of the seeds")
      ->check(CLI::IsMember(simulation::world_names()))
      ->capture_default_str();
  add_jobs_option(command, session.jobs);
  command.add_option("--budget-s", session.budget_s, "Seconds after which no more trials begin")
      ->check(CLI::PositiveNumber);
  command.add_option("--out", session.out,
                     "Folder of the results; resumes the experiment if the folder holds an interrupted one");
  add_shard_options(command, session.shards);
  command.add_option("--json", session.json, "Also write the results to this file");
  command.add_option("--record-lost", session.record_lost,
                     "Keep a recording of each trial that is lost in this folder: CELL-SEED.mcap");
  CLI::Option* page =
      command.add_option("--page", session.page, "Update this Markdown page with the results");
  command.add_option("--section", session.section, "Section of the page that they replace")->needs(page);
}

void add_disturbance_options(CLI::App& command, lab::GyroFeedbackOptions& options) {
  CLI::Option* disturbed =
      command.add_flag("--disturbed", options.disturbed, "Push the trunk, on soft ground");
  add_number(command, "--push", options.push_N_s, 0.0, 10.0, "Strongest push of the disturbed form, in N s")
      ->needs(disturbed);
}

std::vector<Override> overrides_of(const SessionOptions& session) {
  return overrides_of(session.sets, {{"duration_s", session.duration, "--duration"},
                                     {"physics.stepper", session.stepper, "--stepper"},
                                     simulation::robot_override(session.robot)});
}

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
  if (terminal_) print_error("\n");
}

void ProgressLine::show(const std::string& text) const {
  if (!terminal_) return;
  print_error("\r{} ", text);
  std::fflush(stderr);
}

void conduct(const lab::Experiment& experiment, SessionOptions session, Invocation& invocation,
             const DrawFigures& draw_figures) {
  if (session.out.empty()) session.out = fs::path("runs") / experiment.name;
  if (session.section.empty()) session.section = experiment.name;
  check_output_file(session.json);
  check_output_file(session.page);
  if (fs::exists(session.record_lost) && !fs::is_directory(session.record_lost))
    throw InputError(session.record_lost, 0, "a file", "a folder for the recordings");
  std::string command_line = invocation.command_line;
  if (session.shards.is_used()) {
    const lab::JobFile job = job_of(experiment, session, invocation);
    lab::keep_job(session.out, job);
    if (!session.shards.is_merge()) {
      if (session.shards.action.empty()) {
        play_one_shard(experiment, session);
      } else {
        invocation.exit_status =
            show_shards(session.shards, progress_of_shards(experiment, session, job.shards));
      }
      return;
    }
    command_line = job.command_line();
  }
  if (!experiment.warning.empty()) warn(experiment.warning);
  const lab::ExperimentResult result =
      session.shards.is_used() ? lab::merge_shards(experiment, session.out, session.shards.count(session.out),
                                                   session.out / kLogName)
                               : play(experiment, session);
  const lab::Conclusions conclusions =
      experiment.conclude ? experiment.conclude(experiment, result) : lab::Conclusions{};
  nlohmann::ordered_json json = lab::to_json(experiment, result);
  json.update(conclusions.values);
  write_whole_file(session.out / "trials.csv", lab::to_csv(experiment, result));
  simulation::write_json(session.out / "result.json", json);
  if (!session.json.empty()) simulation::write_json(session.json, json);
  const auto table = [&](TableStyle style) {
    return conclusions.table ? conclusions.table(style) : lab::result_table(experiment, result, style);
  };
  const std::string remarks = conclusions.lines + lab::notes(experiment, result);
  fmt::print("{}{}results in {}\n", table(TableStyle::kTerminal), remarks, session.out.string());
  std::string figures = draw_figures ? draw_figures(session) : "";
  if (conclusions.figure) figures += draw_figure(*conclusions.figure, session);
  for (const lab::NamedGrid& named : conclusions.grids) figures += draw_grid(named, session);
  if (session.page.empty()) return;
  write_page(experiment, session, command_line, table(TableStyle::kMarkdown), remarks, figures);
}

}  // namespace koboshi::cli
