#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "base/file/output_file.h"
#include "base/file/overwrite.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "cli/commands.h"
#include "cli/motion/find_motion_file.h"
#include "simulation/motion_language/parse/parse.h"
#include "simulation/scenario/paths.h"
#include "tools/motion_check/check.h"
#include "tools/motion_files/limit_clamp.h"
#include "tools/motion_files/retarget_program.h"

namespace koboshi::cli {
namespace {

struct MotionRetargetArguments {
  std::filesystem::path motion;
  std::filesystem::path from;
  std::filesystem::path to;
  std::filesystem::path out;
  std::optional<double> clamp_deg;
  bool retime = false;
  bool by_targets = false;
};

// "koboshi: stable, least margin 12.3 mm, 6.20 s, 0 errors"
std::string verdict_text(const std::string& robot, const tools::MotionReport& report) {
  std::size_t errors = 0;
  for (const simulation::Diagnostic& diagnostic : report.diagnostics)
    errors += diagnostic.severity == simulation::Severity::kError ? 1 : 0;
  std::string text =
      robot + ": " + std::string(tools::kBalanceNames.at(static_cast<std::size_t>(report.balance)));
  if (report.balance != tools::Balance::kNotJudged)
    text += fmt::format(", least margin {:.1f} mm", report.least_margin_m * kMmPerM);
  return text + fmt::format(", {:.2f} s, {}\n", report.duration_s, count_text(errors, "error"));
}

// Checks the motion, and with `retime` gives moves the time with which the check finds them slow enough: the
// first one begins in the standing pose, and joints need torque beside their speed. A torque that time does
// not mend is left to the verdict.
tools::MotionReport checked(tools::RetargetedMotion& motion, const std::filesystem::path& file,
                            tools::MotionChecker& robot, bool retime) {
  constexpr int kMostRounds = 12;
  constexpr double kMoreTime = 1.1;   // for a torque, in each round
  using Place = std::pair<int, int>;  // line and column
  std::map<Place, double> factors;
  const auto slowed = [&] {
    tools::RetargetedMotion result = motion;
    for (auto move = factors.rbegin(); move != factors.rend(); ++move)  // from the end, so that places stay
      tools::slow_down_move(result, file, robot.model(), move->first.first, move->first.second, move->second);
    return result;
  };
  const auto check = [&](const tools::RetargetedMotion& candidate) {
    return robot.check(robot.compile(simulation::read_motion_text(file, candidate.text)));
  };
  tools::MotionReport report = check(motion);
  for (int round = 0; retime && round < kMostRounds; ++round) {
    std::map<Place, double> more;
    std::set<Place> weak;
    for (const tools::PathReport& path : report.paths) {
      const auto place_of = [&](std::uint16_t step) {
        return Place{report.places[step].line, report.places[step].column};
      };
      for (const tools::StepReport& step : path.steps)
        if (step.speed.share > 1.0)
          more[place_of(step.step)] =
              std::max(more[place_of(step.step)], step.speed.share / tools::kUsableSpeed);
      for (const tools::Finding& finding : path.findings)
        if (finding.code == "C003" && finding.severity == simulation::Severity::kError)
          weak.insert(place_of(finding.step));
    }
    const bool is_last = round + 1 == kMostRounds;
    for (const Place& place : weak) {
      if (is_last)
        factors.erase(place);
      else
        more.emplace(place, kMoreTime);
    }
    if (more.empty() && !is_last) break;
    for (const auto& [place, factor] : more)
      factors[place] = factors.contains(place) ? factors[place] * factor : factor;
    report = check(slowed());
  }
  if (!factors.empty()) motion = slowed();
  return report;
}

int retarget(const MotionRetargetArguments& arguments) {
  const auto from_file = simulation::find_input(simulation::InputKind::kRobot, arguments.from);
  const auto to_file = simulation::find_input(simulation::InputKind::kRobot, arguments.to);
  const auto file = find_motion_file(arguments.motion, from_file);
  tools::MotionChecker from(from_file);
  tools::MotionChecker to(to_file);
  const tools::MotionReport before = from.check(file);
  tools::ConversionOptions options{.retime = arguments.retime, .largest_clamp_rad = {}};
  if (arguments.clamp_deg) options.largest_clamp_rad = kRadPerDegree * *arguments.clamp_deg;
  tools::RetargetedMotion result =
      tools::retarget_program(simulation::read_motion_file(file), {from.robot(), from.model()},
                              {to.robot(), to.model()}, arguments.by_targets, options);
  refuse_to_overwrite({file, from_file, to_file}, arguments.out);
  const auto print_report = [&] {
    for (const std::string& line : result.report) print_error("{}: {}\n", file.string(), utf8_line(line));
  };
  if (result.too_fast > result.stretched) {
    print_report();
    throw InputError(file, 0,
                     count_text(result.too_fast, "move") + " too fast for the servos of " + to.robot().name,
                     "moves that they can do (--retime gives them the time)");
  }
  const tools::MotionReport after = checked(result, arguments.out, to, arguments.retime);
  print_report();
  write_whole_file(arguments.out, result.text);
  fmt::print("before  {}after   {}", verdict_text(from.robot().name, before),
             verdict_text(to.robot().name, after));
  return after.has_errors() ? 1 : 0;
}

}  // namespace

void add_motion_retarget_command(CLI::App& motion_command, Invocation& invocation) {
  auto arguments = std::make_shared<MotionRetargetArguments>();
  CLI::App* command =
      motion_command.add_subcommand("retarget", "Turn a motion of one robot into one of another");
  command->footer(
      R"(Gives each joint the angles of the joint with the same role in the other robot (koboshi model map), within its limits.
Loops, conditions, routines and settings stay as they are. With --by targets, puts soles, trunk, centre of mass and hands
of each pose where they are on the first robot, in lengths of its legs and arms, and computes the angles; for robots of
other proportions. Prints the verdict of koboshi motion check for both robots (docs/reference/motion-import.md). Exit
status 1 if the check finds an error in the result.

Examples:
  koboshi motion retarget wave --from koboshi --to koboshi --retime -o wave_here.yaml
  koboshi motion retarget squat --from koboshi --to noppo --by targets --retime -o squat_there.yaml
)");
  command->add_option("MOTION", arguments->motion, "A motion's file or name, of the robot --from")
      ->required();
  command->add_option("--from", arguments->from, "The robot of the motion: its file or name")
      ->required()
      ->type_name("FILE");
  command->add_option("--to", arguments->to, "The robot that shall play it: its file or name")
      ->required()
      ->type_name("FILE");
  command
      ->add_option_function<std::string>(
          "--by", [arguments](const std::string& by) { arguments->by_targets = by == "targets"; },
          "What both robots have in common: angles of joints, or targets of soles, hands and centre of mass")
      ->check(CLI::IsMember({"joints", "targets"}))
      ->type_name("WHAT:{joints,targets}")
      ->default_str("joints");
  command->add_flag("--retime", arguments->retime, "Give moves the time that the servos need");
  command
      ->add_option("--clamp", arguments->clamp_deg,
                   "Refuse angles that are further beyond a limit (default: clamp all)")
      ->type_name("DEGREES")
      ->check(CLI::Range(0.0, 360.0));
  command->add_option("-o,--out", arguments->out, "The motion file for the other robot")
      ->required()
      ->type_name("FILE");
  command->callback([arguments, &invocation] { invocation.exit_status = retarget(*arguments); });
}

}  // namespace koboshi::cli
