#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/file/output_file.h"
#include "base/file/overwrite.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "base/text/shell_word.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "cli/commands.h"
#include "cli/motion/find_motion_file.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/paths.h"
#include "tools/motion_files/convert.h"
#include "tools/motion_files/format/readers.h"
#include "tools/motion_files/joint_map.h"
#include "tools/motion_files/joint_map_file.h"

namespace koboshi::cli {
namespace {

struct MotionImportArguments {
  std::string file;
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  std::filesystem::path map;
  std::filesystem::path out;
  std::optional<double> clamp_deg;
  bool retime = false;
  bool list = false;
  bool all = false;
};

// The robot that motions are converted for, and how.
struct Destination {
  sim_board::RobotDescription robot;
  simulation::NamedModel model;
  std::optional<tools::JointMapFile> map;
  tools::ConversionOptions options;
};

std::string read_bytes(const std::filesystem::path& file) {
  return read_text_file(file, "a motion file of another maker");
}

// Takes a page number off the end of FILE:PAGE, unless a file has that name.
std::optional<int> take_page(std::string& file) {
  const std::size_t colon = file.rfind(':');
  if (colon == std::string::npos || std::filesystem::exists(file)) return std::nullopt;
  const auto page = parse_integer(std::string_view(file).substr(colon + 1));
  if (!page || *page < 0 || *page > 100'000) return std::nullopt;
  file.resize(colon);
  return static_cast<int>(*page);
}

std::string page_text(const tools::ForeignMotion& motion) {
  std::size_t frames = 0;
  for (const tools::ForeignSection& section : motion.sections) frames += section.frames.size();
  return fmt::format("{:4}  {:16}  {}", motion.page, motion.name, count_text(frames, "frame"));
}

const tools::ForeignMotion& choose(const std::filesystem::path& file,
                                   const std::vector<tools::ForeignMotion>& motions,
                                   const std::optional<int>& page) {
  if (!page && motions.size() == 1) return motions.front();
  const auto found = std::ranges::find_if(
      motions, [&](const tools::ForeignMotion& motion) { return page && motion.page == *page; });
  if (found != motions.end()) return *found;
  if (!page)
    throw InputError(file, 0, count_text(motions.size(), "page") + " with motions",
                     "FILE:PAGE, or --all; koboshi motion import --list FILE shows them");
  throw InputError(file, 0, "no motion on page " + std::to_string(*page),
                   "one of the pages that koboshi motion import --list FILE shows");
}

Destination destination_of(const MotionImportArguments& arguments) {
  const std::filesystem::path file = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
  sim_board::RobotDescription robot = sim_board::load_robot(file);
  simulation::NamedModel model = simulation::load_named_model(robot);
  tools::ConversionOptions options{.retime = arguments.retime, .largest_clamp_rad = {}};
  if (arguments.clamp_deg) options.largest_clamp_rad = kRadPerDegree * *arguments.clamp_deg;
  std::optional<tools::JointMapFile> map;
  if (!arguments.map.empty()) map.emplace(arguments.map, robot);
  return {std::move(robot), std::move(model), std::move(map), options};
}

// Converts a motion and says what was changed in it. `place` is FILE or FILE:PAGE.
tools::ConvertedMotion convert(const std::string& place, const std::filesystem::path& file,
                               const tools::ForeignMotion& motion, const Destination& to) {
  const tools::JointMap joints = tools::find_joints(file, motion, to.robot, to.map ? &*to.map : nullptr);
  tools::ConvertedMotion converted = tools::convert_motion(file, motion, joints, to.model, to.options);
  for (const std::string& line : converted.report) print_error("{}: {}\n", place, utf8_line(line));
  print_error(
      "{}: {}; {} left out as straight, {} clamped, {} stretched; {:.3f} s in the file, {:.3f} s now\n",
      place, count_text(converted.frames, "frame"), converted.left_out,
      count_text(converted.clamped, "angle"), count_text(converted.stretched, "move"), converted.original_s,
      converted.duration_s);
  if (converted.too_fast > converted.stretched)
    print_error("{}: {} too fast for the servos; --retime gives them the time\n", place,
                converted.too_fast == 1 ? "a move is" : std::to_string(converted.too_fast) + " moves are");
  return converted;
}

// 007_look_left.yaml
std::string file_name(const tools::ForeignMotion& motion) {
  std::string name = fmt::format("{:03}", motion.page);
  bool gap = true;
  for (const char c : motion.name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain && gap) name += '_';
    if (plain) name += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    gap = !plain;
  }
  return name + ".yaml";
}

// Imports each page into a file of its own. Pages that cannot be converted are named; returns 1 if there are
// any. Writes nothing before all pages are converted.
int import_all(const MotionImportArguments& arguments, const std::vector<tools::ForeignMotion>& motions) {
  if (arguments.out.empty()) throw InputError(arguments.file, 0, "--all without a folder", "-o FOLDER");
  for (const tools::ForeignMotion& motion : motions) {
    const std::filesystem::path out = arguments.out / file_name(motion);
    if (std::filesystem::exists(out))
      throw InputError(out, 0, "a file of this name", "a folder without it: nothing is overwritten");
  }
  const std::filesystem::path file = arguments.file;
  const Destination to = destination_of(arguments);
  std::vector<std::pair<std::filesystem::path, std::string>> results;
  for (const tools::ForeignMotion& motion : motions) {
    const std::string place = fmt::format("{}:{}", arguments.file, motion.page);
    try {
      results.emplace_back(arguments.out / file_name(motion), convert(place, file, motion, to).text);
    } catch (const InputError& error) {
      if (error.file() != file) throw;  // of the robot, and so of every page
      print_error("{}: left out: {}\n", place, error.what());
    }
  }
  std::filesystem::create_directories(arguments.out);
  for (const auto& [out, text] : results) write_whole_file(out, text);
  fmt::print("{} of {} imported into {}\n", results.size(), count_text(motions.size(), "page"),
             arguments.out.string());
  return results.size() == motions.size() ? 0 : 1;
}

int import_motion(MotionImportArguments& arguments) {
  const std::optional<int> page = take_page(arguments.file);
  const std::filesystem::path file = arguments.file;
  const std::vector<tools::ForeignMotion> motions = tools::read_foreign_motions(file, read_bytes(file));
  if (arguments.list) {
    for (const tools::ForeignMotion& motion : motions) fmt::print("{}\n", page_text(motion));
    return 0;
  }
  if (arguments.all) {
    if (page) throw InputError(file, 0, fmt::format("page {} and --all", *page), "one of them");
    return import_all(arguments, motions);
  }
  const tools::ForeignMotion& motion = choose(file, motions, page);
  const std::string text = convert(file.string(), file, motion, destination_of(arguments)).text;
  if (arguments.out.empty()) {
    fmt::print("{}", text);
    return 0;
  }
  refuse_to_overwrite({file, arguments.map}, arguments.out);
  write_whole_file(arguments.out, text);
  return 0;
}

}  // namespace

std::filesystem::path find_motion_file(const std::filesystem::path& given,
                                       const std::filesystem::path& robot) {
  const std::filesystem::path file = simulation::find_motion(given, robot);
  std::error_code missing;
  if (!std::filesystem::is_regular_file(file, missing)) return file;
  if (const auto format = tools::recognise(read_text_file(file, "a motion file")))
    throw InputError(
        file, 0, tools::name_of(*format),
        "a motion file: koboshi motion import " + shell_word(file.string()) + " makes one of it");
  return file;
}

void add_motion_import_command(CLI::App& motion_command, Invocation& invocation) {
  auto arguments = std::make_shared<MotionImportArguments>();
  CLI::App* command =
      motion_command.add_subcommand("import", "Convert a motion of another maker into a motion file");
  command->footer(
      R"(Reads motions of Webots (.motion), ROBOTIS (.mtn, .mtnx, motion_*.bin), KONDO (.h4p), Choreonoid (.pseq), the
Bit-Bots and bold-humanoid (JSON), and tables (CSV), which it recognises by their contents. Joints are found by the robot's servo
numbers (koboshi model map) or by their names. What was clamped, slowed down, dropped or guessed is said on the
standard error output (docs/reference/motion-import.md).

Examples:
  koboshi motion import docs/tutorial/bring-your-motions/nod.csv --retime -o nod.yaml
  koboshi motion import --list docs/tutorial/bring-your-motions/pages.mtn
  koboshi motion import docs/tutorial/bring-your-motions/pages.mtn:2 --map docs/tutorial/bring-your-motions/servos.yaml
  koboshi motion import docs/tutorial/bring-your-motions/pages.mtn --all --map docs/tutorial/bring-your-motions/servos.yaml -o motions
)");
  command->add_option("FILE", arguments->file, "The motion's file; FILE:PAGE for a page of a file with pages")
      ->required();
  command->add_option("--robot", arguments->robot, "The robot's file or name")->capture_default_str();
  command->add_option("--map", arguments->map, "Which joint of the robot each joint of the file is")
      ->type_name("FILE");
  command->add_flag("--retime", arguments->retime, "Give moves the time that the servos need");
  command
      ->add_option("--clamp", arguments->clamp_deg,
                   "Refuse angles that are further beyond a limit (default: clamp all)")
      ->type_name("DEGREES")
      ->check(CLI::Range(0.0, 360.0));
  CLI::Option* list = command->add_flag("--list", arguments->list, "Only list the pages of the file");
  command->add_flag("--all", arguments->all, "Import each page into a file of its own in the folder of --out")
      ->excludes(list);
  command
      ->add_option("-o,--out", arguments->out,
                   "The motion file (default: standard output), or the folder of --all")
      ->type_name("PATH");
  command->callback([arguments, &invocation] { invocation.exit_status = import_motion(*arguments); });
}

}  // namespace koboshi::cli
