#include "cli/commands.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/servo_types.h"
#include "simulation/scenario/paths.h"
#include "tools/servo/datasheet.h"
#include "tools/servo/servo_figures.h"

namespace koboshi::cli {
namespace {

bool is_plain(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
}

// --- plot

struct PlotArguments {
  std::filesystem::path file;
  std::string type;
  std::filesystem::path out = "runs/servo";
};

// The types of the file, or only that of --type.
sim_board::ServoTypes asked_types(const PlotArguments& arguments) {
  sim_board::ServoTypes types = sim_board::read_servo_types(arguments.file);
  std::vector<std::string> names;
  for (const auto& [name, servo] : types) {
    // Each becomes a folder's name.
    if (!is_plain(name))
      throw InputError(arguments.file, 0, "servo type " + one_line(name),
                       "a name of letters, digits, _ and -");
    names.push_back(name);
  }
  if (types.empty()) throw InputError(arguments.file, 0, "no servo type", "one or more");
  if (arguments.type.empty()) return types;
  const auto asked = types.find(arguments.type);
  if (asked == types.end()) throw InputError("--type", 0, one_line(arguments.type), join_alternatives(names));
  return {*asked};
}

void plot(PlotArguments& arguments) {
  arguments.file = simulation::find_input(simulation::InputKind::kRobot, arguments.file);
  const sim_board::ServoTypes types = asked_types(arguments);
  if (std::filesystem::exists(arguments.out) && !std::filesystem::is_directory(arguments.out))
    throw InputError(arguments.out, 0, "a file", "a folder, or nothing yet");
  for (const auto& [name, servo] : types) {
    tools::draw_servo(name, servo, arguments.out / name);
    fmt::print("{}: torque_speed, step, sine, friction_speed, friction_load, backlash (csv, png, svg)\n",
               (arguments.out / name).string());
  }
}

void add_plot_command(CLI::App& servo) {
  auto arguments = std::make_shared<PlotArguments>();
  CLI::App* command = servo.add_subcommand("plot", "Simulate servos on a test bench and plot the results");
  command->footer(
      R"(Simulates each servo type with the robot's model and physics: torque over speed, a step, a sine under load,
friction over speed and load, and the backlash of the shaft.

Examples:
  koboshi servo plot robots/koboshi/robot.sdf
  koboshi servo plot robots/servos/bam.xml --type mx_64_m6 --out mx_64)");
  command
      ->add_option("FILE", arguments->file,
                   "A robot's file or name, or a library of servo types, docs/reference/servo.md")
      ->required();
  command->add_option("--type", arguments->type, "Plot only this type");
  command->add_option("-o,--out", arguments->out, "Folder of the figures, with a folder for each type")
      ->capture_default_str();
  command->callback([arguments] { plot(*arguments); });
}

// --- from-datasheet

void check(const std::string& option, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw InputError(option, 0, number_text(value), koboshi::describe(NumberRange{low, high}));
}

void print_servo_type(const tools::Datasheet& sheet) {
  if (!is_plain(sheet.name)) throw InputError("--name", 0, one_line(sheet.name), "letters, digits, _ and -");
  check("--stall-torque-Nm", sheet.stall_torque_Nm, 1e-3, 100.0);
  check("--no-load-speed-rad-per-s", sheet.no_load_speed_rad_per_s, 0.01, 1000.0);
  check("--voltage-V", sheet.voltage_V, 0.1, 1000.0);
  check("--ratio", sheet.ratio, 1.0, 1e5);
  check("--dry-friction-share", sheet.dry_friction_share, 0.0, 0.5);
  check("--viscous-friction-share", sheet.viscous_friction_share, 0.0, 0.5);
  check("--time-constant-s", sheet.time_constant_s, 0.0, 1.0);
  check("--full-voltage-error-rad", sheet.full_voltage_error_rad, 1e-4, 10.0);
  fmt::print("{}", tools::servo_type_from(sheet));
}

void add_datasheet_command(CLI::App& servo) {
  auto sheet = std::make_shared<tools::Datasheet>();
  CLI::App* command = servo.add_subcommand("from-datasheet", "Make a servo type from a data sheet");
  command->footer(
      R"(Prints a library of one koboshi:servo_type, with its assumptions as comments. Copy it into a robot's file
(docs/reference/servo.md), or plot it with `koboshi servo plot`.

Example, a KONDO KRS-2552RHV:
  koboshi servo from-datasheet --stall-torque-Nm 1.373 --no-load-speed-rad-per-s 7.48 --voltage-V 7.5 \
      --ratio 276 --name krs_2552 > krs_2552.xml
  koboshi servo plot krs_2552.xml)");
  command->add_option("--stall-torque-Nm", sheet->stall_torque_Nm, "Torque at rest")->required();
  command->add_option("--no-load-speed-rad-per-s", sheet->no_load_speed_rad_per_s, "Speed without load")
      ->required();
  command->add_option("--voltage-V", sheet->voltage_V, "Supply voltage of both values")->required();
  command->add_option("--ratio", sheet->ratio, "Gear ratio: turns of the rotor per turn of the output")
      ->required();
  command->add_option("--name", sheet->name, "Name of the type")->capture_default_str();
  command
      ->add_option("--dry-friction-share", sheet->dry_friction_share,
                   "Dry friction, as a share of the stall torque")
      ->capture_default_str();
  command
      ->add_option("--viscous-friction-share", sheet->viscous_friction_share,
                   "Viscous friction at no-load speed, as a share of the stall torque")
      ->capture_default_str();
  command
      ->add_option("--time-constant-s", sheet->time_constant_s,
                   "Mechanical time constant of motor and gears: J R / kt^2")
      ->capture_default_str();
  command
      ->add_option("--full-voltage-error-rad", sheet->full_voltage_error_rad,
                   "Position error at which the drive applies its full voltage")
      ->capture_default_str();
  command->callback([sheet] { print_servo_type(*sheet); });
}

}  // namespace

void add_servo_command(CLI::App& program, Invocation&) {
  CLI::App* servo = program.add_subcommand("servo", "Plot servo models, and make them from data sheets");
  servo->require_subcommand(1);
  add_plot_command(*servo);
  add_datasheet_command(*servo);
}

}  // namespace koboshi::cli
