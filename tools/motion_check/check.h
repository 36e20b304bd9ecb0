#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "simulation/assembly/parameters.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/diagnostic.h"
#include "simulation/motion_language/parse/parse.h"
#include "tools/motion_check/analysis.h"
#include "tools/motion_check/report.h"
#include "tools/motion_check/sample.h"
#include "tools/motion_check/trajectory.h"

namespace koboshi::tools {

// The result of `koboshi motion check`.
struct MotionReport {
  std::filesystem::path file{};
  std::string name{};
  std::vector<StepPlace> places{};    // by step of the image
  std::vector<std::string> joints{};  // that the motion claims
  std::vector<PathReport> paths{};
  std::vector<simulation::Diagnostic> diagnostics{};  // of all paths, in the order of the file
  bool endless = false;
  bool cut = false;
  // The worst of the paths.
  Balance balance = Balance::kNotJudged;
  double least_margin_m = 0.0;  // 0 if not judged
  double least_margin_s = 0.0;
  std::uint16_t least_margin_step = 0;
  double duration_s = 0.0;    // the longest, with time-outs
  bool duration_cut = false;  // a path was cut (kMaxPathTicks): the motion takes longer

  bool has_errors() const;
};

// A motion's file as the check reads it.
struct CompiledMotion {
  std::filesystem::path file{};
  std::string text{};  // of the file
  std::string name{};
  std::vector<std::byte> image{};
  std::vector<StepPlace> places{};               // by step
  std::vector<simulation::Diagnostic> unused{};  // what the source names and nothing plays
};

// Checks the motions of a robot, one after the other; what an edit leaves as it was is not computed again.
// One thread at a time may use it.
class MotionChecker {
 public:
  // Reads the robot's file, its parameters and its standing motion (motions/stand.yaml beside it; without
  // one, motions begin at joint angles zero). Throws InputError.
  explicit MotionChecker(const std::filesystem::path& robot_file);

  // Throws InputError for a file that the compiler refuses.
  [[nodiscard]] CompiledMotion compile(const std::filesystem::path& file) const;
  // The same for a text that need not be that of the file.
  [[nodiscard]] CompiledMotion compile(const simulation::MotionFile& motion) const;
  MotionReport check(const CompiledMotion& motion);
  // Returns nothing, within a tick of the motion, once `cancel` is set from another thread; what was computed
  // is kept for the next call.
  std::optional<MotionReport> check(const CompiledMotion& motion, const std::stop_token& cancel);
  MotionReport check(const std::filesystem::path& file) { return check(compile(file)); }

  // The first path of the last check, with its states: what plot and preview show.
  const Trajectory& trajectory() const { return trajectory_; }
  const std::vector<TickState>& states() const { return states_; }
  const sim_board::RobotDescription& robot() const { return *robot_; }
  const simulation::NamedModel& model() const { return model_; }
  const MotionAnalysis& analysis() const { return analysis_; }
  CheckLimits& limits() { return limits_; }

 private:
  MotionChecker(const std::filesystem::path& robot_file, const app::ControllerValues& values);
  void add_path(PathReport path, const Trajectory& trajectory, MotionReport& report) const;
  void add_diagnostics(const CompiledMotion& motion, MotionReport& report) const;

  std::shared_ptr<const sim_board::RobotDescription> robot_;  // at a fixed address: the analyses refer to it
  simulation::NamedModel model_;
  CheckLimits limits_;
  MotionAnalysis analysis_;
  Trajectory trajectory_;
  std::vector<TickState> states_;
};

}  // namespace koboshi::tools
