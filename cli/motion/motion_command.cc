#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/file/output_file.h"
#include "base/file/overwrite.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "cli/commands.h"
#include "cli/motion/find_motion_file.h"
#include "cli/motion/motion_robot_command.h"
#include "cli/options.h"
#include "firmware/motion/motion.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/compile/decompile.h"
#include "simulation/motion_language/parse/parse.h"
#include "simulation/scenario/paths.h"
#include "tools/motion_edit/format.h"
#include "tools/motion_edit/mirror.h"

namespace koboshi::cli {
namespace {

using simulation::NamedModel;

constexpr int kWouldChange = 1;
constexpr int kBadMotion = 2;

struct MotionArguments {
  std::vector<std::filesystem::path> motions;
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  std::filesystem::path out;
  std::optional<std::string> name;
  bool json = false;
  bool check = false;
  bool upgrade = false;
  CanOptions can;

  const std::filesystem::path& motion() const { return motions.front(); }
};

void find_inputs(MotionArguments& arguments) {
  arguments.robot = simulation::find_input(simulation::InputKind::kRobot, arguments.robot);
  for (std::filesystem::path& motion : arguments.motions) motion = find_motion_file(motion, arguments.robot);
}

NamedModel load(const MotionArguments& arguments) {
  return simulation::load_named_model(sim_board::load_robot(arguments.robot));
}

std::string read(const std::filesystem::path& file) { return read_text_file(file, "a motion file"); }

void write(const std::filesystem::path& file, const std::string& text) {
  if (file.empty()) {
    fmt::print("{}", text);
  } else {
    write_whole_file(file, text);
  }
}

std::string bytes_text(const std::vector<std::byte>& image) {
  return {reinterpret_cast<const char*>(image.data()), image.size()};
}

// Compiles a text; the messages go to standard error. Throws MotionError.
std::vector<std::byte> compile_text(const std::filesystem::path& file, const std::string& text,
                                    const NamedModel& model, std::vector<simulation::Diagnostic>& messages) {
  const simulation::MotionFile read = simulation::read_motion_text(file, text);
  simulation::Diagnostics diagnostics(read.path, read.text);
  const simulation::MotionSource source = simulation::parse_motion(read, model, diagnostics);
  std::vector<std::byte> image = simulation::compile_motion(source, model, diagnostics).image;
  diagnostics.throw_errors();
  messages = diagnostics.all();
  return image;
}

int compile(const MotionArguments& arguments) {
  const NamedModel model = load(arguments);
  std::vector<simulation::Diagnostic> messages;
  std::vector<std::byte> image;
  try {
    image = compile_text(arguments.motion(), read(arguments.motion()), model, messages);
  } catch (const simulation::MotionError& error) {
    messages = error.diagnostics();
  }
  if (arguments.json) {
    fmt::print("{}", simulation::json_text(messages));
  } else {
    print_error("{}", simulation::print(messages));
  }
  if (image.empty()) return kBadMotion;
  std::filesystem::path out = arguments.out;
  if (out.empty()) out = arguments.motion().stem().string() + ".kmot";
  refuse_to_overwrite({arguments.motion(), arguments.robot}, out);
  write_whole_file(out, bytes_text(image));
  if (!arguments.json)
    fmt::print("{}: {} bytes for robot model {:08x}\n", out.string(), image.size(), model.model.id);
  return 0;
}

int decompile(const MotionArguments& arguments) {
  refuse_to_overwrite({arguments.motion(), arguments.robot}, arguments.out);
  const std::string bytes = read_text_file(arguments.motion(), "the image of a motion");
  write(arguments.out, simulation::decompile_motion(std::as_bytes(std::span(bytes)), load(arguments),
                                                    arguments.motion().string()));
  return 0;
}

// Returns the upgraded text, which must give the same image.
std::string upgraded(const std::filesystem::path& file, const std::string& text, const NamedModel& model) {
  const std::string changed = tools::upgrade_motion(file, text);
  std::vector<simulation::Diagnostic> messages;
  if (compile_text(file, text, model, messages) == compile_text(file, changed, model, messages))
    return changed;
  throw InputError(file, 0, "a motion whose image would change", "one that is the same in version 2");
}

int format(const MotionArguments& arguments) {
  int status = 0;
  std::optional<NamedModel> model;
  if (arguments.upgrade) model = load(arguments);
  for (const std::filesystem::path& file : arguments.motions) {
    const std::string text = simulation::read_motion_text(file, read(file)).text;
    const std::string formatted = tools::format_motion(file, model ? upgraded(file, text, *model) : text);
    if (formatted == text) continue;
    fmt::print("{}{}\n", file.string(), arguments.check ? " would change" : "");
    if (arguments.check) {
      status = kWouldChange;
    } else {
      write_whole_file(file, formatted);
    }
  }
  return status;
}

int mirror(const MotionArguments& arguments) {
  const NamedModel model = load(arguments);
  const std::string text = read(arguments.motion());
  std::vector<simulation::Diagnostic> messages;
  static_cast<void>(compile_text(arguments.motion(), text, model, messages));
  const std::string mirrored =
      tools::mirror_motion(arguments.motion(), text, simulation::JointNames(model), arguments.name);
  // Checks the result, such as a name that is too long.
  static_cast<void>(
      compile_text(arguments.out.empty() ? arguments.motion() : arguments.out, mirrored, model, messages));
  write(arguments.out, mirrored);
  return 0;
}

int list(const MotionArguments& arguments) {
  const NamedModel model = load(arguments);
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& path : arguments.motions) {
    if (!std::filesystem::is_directory(path)) files.push_back(path);
    if (!std::filesystem::is_directory(path)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      if (extension_of(entry.path()) == ".yaml") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  int status = 0;
  fmt::print("{:24}  {:>5}  {:>5}  {:>5}  {:>6}  {}\n", "name", "poses", "steps", "bytes", "joints", "file");
  for (const std::filesystem::path& file : files) {
    std::vector<simulation::Diagnostic> messages;
    try {
      const std::vector<std::byte> image = compile_text(file, read(file), model, messages);
      motion::Motion motion;
      if (!motion::Motion::open(image, model.model, motion).ok()) continue;
      fmt::print("{:24}  {:5}  {:5}  {:5}  {:6}  {}\n", motion.name(), motion.pose_count(),
                 motion.step_count(), image.size(), std::popcount(motion.claimed_joints()), file.string());
    } catch (const simulation::MotionError& error) {
      print_error("{}", simulation::print(error.diagnostics()));
      status = kBadMotion;
    }
  }
  return status;
}

template <typename Command>
void set_callback(CLI::App& app, Invocation& invocation, const std::shared_ptr<MotionArguments>& arguments,
                  Command command) {
  app.callback([&invocation, arguments, command] {
    find_inputs(*arguments);
    invocation.exit_status = command(*arguments);
  });
}

CLI::App& add_command(CLI::App& parent, const std::string& name, const std::string& help,
                      const std::string& example, MotionArguments& arguments) {
  CLI::App* command = parent.add_subcommand(name, help);
  command->footer("Example:\n  koboshi motion " + example + "\n");
  command->add_option("--robot", arguments.robot, "The robot's file or name")->capture_default_str();
  return *command;
}

void add_file(CLI::App& command, MotionArguments& arguments, const std::string& name,
              const std::string& help) {
  command.add_option(name, arguments.motions, help)->required()->expected(1);
}

void add_out(CLI::App& command, MotionArguments& arguments, const std::string& help) {
  command.add_option("-o,--out", arguments.out, help)->type_name("FILE");
}

constexpr const char* kMotionHelp = "A motion's file or name, docs/reference/motion-language.md";

void add_compile(CLI::App& parent, Invocation& invocation) {
  auto arguments = std::make_shared<MotionArguments>();
  CLI::App& command =
      add_command(parent, "compile", "Compile a motion file into the image that the firmware plays",
                  "compile robots/koboshi/motions/squat.yaml -o squat.kmot", *arguments);
  add_file(command, *arguments, "MOTION", kMotionHelp);
  add_out(command, *arguments, "The image (default: the motion's name with .kmot, here)");
  command.add_flag("--json", arguments->json, "Print the messages as JSON, for editors");
  set_callback(command, invocation, arguments, compile);
}

void add_decompile(CLI::App& parent, Invocation& invocation) {
  auto arguments = std::make_shared<MotionArguments>();
  CLI::App& command =
      add_command(parent, "decompile", "Write an image as a motion file that compiles to the same bytes",
                  "decompile squat.kmot -o squat.yaml", *arguments);
  add_file(command, *arguments, "IMAGE", "The image of a motion for this robot");
  add_out(command, *arguments, "The motion file (default: standard output)");
  set_callback(command, invocation, arguments, decompile);
}

void add_format(CLI::App& parent, Invocation& invocation) {
  auto arguments = std::make_shared<MotionArguments>();
  CLI::App& command =
      add_command(parent, "format", "Bring motion files into their canonical layout, with all comments",
                  "format --check robots/koboshi/motions/*.yaml", *arguments);
  command.add_option("MOTION", arguments->motions, kMotionHelp)->required();
  command.add_flag("--check", arguments->check,
                   "Only name the files that would change; exit status 1 if there is one");
  command.add_flag("--upgrade", arguments->upgrade, "Also convert version 1 of the language to version 2");
  set_callback(command, invocation, arguments, format);
}

void add_mirror(CLI::App& parent, Invocation& invocation) {
  auto arguments = std::make_shared<MotionArguments>();
  CLI::App& command =
      add_command(parent, "mirror", "Exchange left and right in a motion file",
                  "mirror robots/koboshi/motions/roll_left.yaml -o roll_right.yaml", *arguments);
  add_file(command, *arguments, "MOTION", kMotionHelp);
  add_out(command, *arguments, "The mirrored file (default: standard output)");
  command.add_option("--name", arguments->name,
                     "Name of the result (default: with left and right exchanged)");
  set_callback(command, invocation, arguments, mirror);
}

void add_list(CLI::App& parent, Invocation& invocation) {
  auto arguments = std::make_shared<MotionArguments>();
  arguments->motions = {"robots/koboshi/motions"};
  CLI::App& command =
      add_command(parent, "list", "List motion files with their size, or the robot's motions",
                  "list robots/koboshi/motions\n  koboshi motion list --can socketcan:vcan0", *arguments);
  CLI::Option* files = command.add_option("PATH", arguments->motions, "Motion files, or folders of them")
                           ->capture_default_str();
  add_can_options(command, arguments->can, files);
  const CLI::Option* can = command.get_option("--can");
  set_callback(command, invocation, arguments, [can](const MotionArguments& given) {
    return can->count() > 0 ? list_on_robot(given.can) : list(given);
  });
}

}  // namespace

void add_motion_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand("motion", "Check, compile and edit motions");
  command->require_subcommand(1);
  add_motion_check_command(*command, invocation);
  add_motion_import_command(*command, invocation);
  add_motion_export_command(*command, invocation);
  add_motion_retarget_command(*command, invocation);
  add_motion_plot_command(*command, invocation);
  add_motion_preview_command(*command, invocation);
  add_compile(*command, invocation);
  add_decompile(*command, invocation);
  add_format(*command, invocation);
  add_mirror(*command, invocation);
  add_list(*command, invocation);
  add_motion_robot_commands(*command, invocation);
}

}  // namespace koboshi::cli
