// koboshi policy: learned controllers, from an ONNX file to the robot.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "base/file/output_file.h"
#include "base/file/overwrite.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "firmware/policy/policy.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/policy/policy_file.h"
#include "simulation/scenario/paths.h"
#include "tools/policy/onnx_reader.h"
#include "tools/policy/policy_map.h"
#include "tools/policy/policy_on_robot.h"
#include "tools/policy/quantise.h"
#include "tools/policy/recorded_inputs.h"

namespace koboshi::cli {
namespace {

constexpr double kDegreesPerRad = 180.0 / std::numbers::pi;

struct PolicyArguments {
  std::filesystem::path file;
  std::filesystem::path map;
  std::filesystem::path inputs;
  std::filesystem::path robot = "robots/koboshi/robot.sdf";
  std::filesystem::path out;
  CanOptions can;
};

simulation::NamedModel load(const PolicyArguments& arguments) {
  return simulation::load_named_model(
      sim_board::load_robot(simulation::find_input(simulation::InputKind::kRobot, arguments.robot)));
}

std::vector<std::vector<double>> read_recorded(const PolicyArguments& arguments,
                                               const tools::PolicyMap& map) {
  std::vector<std::string> columns;
  for (const tools::MappedInput& input : map.inputs) columns.push_back(input.column);
  auto rows = tools::read_recorded_columns(arguments.inputs, columns);
  for (std::vector<double>& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) row[i] *= map.inputs[i].column_scale;
  }
  return rows;
}

void import_policy(const PolicyArguments& arguments) {
  const simulation::NamedModel robot = load(arguments);
  const tools::PolicyMap map = tools::read_policy_map(arguments.map, robot);
  const tools::Mlp network = tools::read_onnx(arguments.file, map.onnx_output);
  const auto rows = read_recorded(arguments, map);
  const tools::QuantisedPolicy policy = tools::quantise(network, map, rows, robot, arguments.file);
  const std::filesystem::path out =
      arguments.out.empty() ? std::filesystem::path(arguments.file.stem().string() + ".kpol") : arguments.out;
  refuse_to_overwrite({arguments.file, arguments.map, arguments.inputs}, out);
  write_whole_file(out, {reinterpret_cast<const char*>(policy.image.data()), policy.image.size()});
  fmt::print("{}: {} bytes for robot model {:08x}; {} weights, at most {} of {} instructions in a tick\n",
             out.string(), policy.image.size(), robot.model.id, policy.weights, policy.work,
             policy::kMaxWork);
  fmt::print("error against floating point, over {} recorded rows:\n", rows.size());
  for (std::size_t i = 0; i < policy.errors.size(); ++i) {
    const tools::QuantisationError& error = policy.errors[i];
    fmt::print("  {:24} largest {:.4f} deg, rms {:.4f} deg, of offsets up to {:.3f} deg\n",
               map.outputs[i].joint, error.largest_rad * kDegreesPerRad, error.rms_rad * kDegreesPerRad,
               error.range_rad * kDegreesPerRad);
  }
  if (policy.clamped_rows > 0)
    fmt::print("in {} of them an output exceeds its bound: the watchdog would count them\n",
               policy.clamped_rows);
}

void show(const PolicyArguments& arguments) {
  const simulation::NamedModel robot = load(arguments);
  const std::vector<std::byte> image = simulation::read_policy_image(arguments.file, robot.model);
  policy::Policy policy;
  static_cast<void>(policy::Policy::open(image, robot.model, policy));
  fmt::print("{}: {} inputs, {} outputs, {} layers; at most {} of {} instructions in a tick\n", policy.name(),
             policy.input_count(), policy.output_count(), policy.layer_count(), policy.work(),
             policy::kMaxWork);
  constexpr double kDegreesPerRaw = 360.0 / 4'294'967'296.0;
  for (std::size_t i = 0; i < policy.output_count(); ++i) {
    const policy::Output output = policy.output(i);
    fmt::print("  {:24} within {:.2f} deg, at most {:.1f} deg/s\n", robot.joint_names[output.joint],
               output.bound.raw() * kDegreesPerRaw, output.rate.raw() * kDegreesPerRaw * 100.0);
  }
}

void upload(const PolicyArguments& arguments) {
  const simulation::NamedModel robot = load(arguments);
  const std::vector<std::byte> image = simulation::read_policy_image(arguments.file, robot.model);
  const auto transport = open_can(arguments.can);
  tools::PolicyOnRobot(*transport).upload(image);
  fmt::print("{}: {} bytes, read back the same; object 2150:1 enables it\n", arguments.file.string(),
             image.size());
}

void add_import(CLI::App& parent) {
  const auto arguments = std::make_shared<PolicyArguments>();
  CLI::App* command =
      parent.add_subcommand("import", "Quantise a network in ONNX into the image that the firmware runs");
  command->footer(
      R"(Reads a multilayer perceptron (Gemm, MatMul, Add; Relu, Elu, Tanh, SiLU; the Sub, Div, Mul and Clip of a
normaliser; a Slice or Split of the mean) and names any other node. The map names the robot's signals and joints,
docs/reference/policy.md. Ranges and errors are those of the recorded inputs.

Example:
  koboshi policy import docs/tutorial/policy/lean.onnx --map docs/tutorial/policy/lean.yaml \
      --inputs docs/tutorial/policy/lean.csv -o lean.kpol)");
  command->add_option("FILE", arguments->file, "The network, an ONNX file")->required();
  command->add_option("--map", arguments->map, "Which signals and joints its inputs and outputs are")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--inputs", arguments->inputs,
                   "Recorded inputs: CSV with a column for each, such as a trace.csv")
      ->required();
  command->add_option("--robot", arguments->robot, "The robot's file or name")->capture_default_str();
  command->add_option("-o,--out", arguments->out, "The image (default: the file's name with .kpol, here)")
      ->type_name("FILE");
  command->callback([arguments] { import_policy(*arguments); });
}

void add_show(CLI::App& parent) {
  const auto arguments = std::make_shared<PolicyArguments>();
  CLI::App* command = parent.add_subcommand("show", "Check an image for a robot, and list its outputs");
  command->add_option("FILE", arguments->file, "The image of a policy (.kpol)")->required();
  command->add_option("--robot", arguments->robot, "The robot's file or name")->capture_default_str();
  command->callback([arguments] { show(*arguments); });
}

void add_upload(CLI::App& parent) {
  const auto arguments = std::make_shared<PolicyArguments>();
  CLI::App* command =
      parent.add_subcommand("upload", "Store a policy in the robot on the bus, and read it back");
  command->footer(
      R"(The robot refuses a policy for another robot. It is off until object 2150:1 is 1. In a simulation the
scenario's key `policy` puts an image into the robot.)");
  command->add_option("FILE", arguments->file, "The image of a policy (.kpol)")->required();
  command->add_option("--robot", arguments->robot, "The robot's file or name")->capture_default_str();
  add_can_options(*command, arguments->can);
  command->callback([arguments] { upload(*arguments); });
}

}  // namespace

void add_policy_command(CLI::App& program, Invocation&) {
  CLI::App* command = program.add_subcommand("policy", "Import, check and upload learned controllers");
  command->require_subcommand(1);
  add_import(*command);
  add_show(*command);
  add_upload(*command);
}

}  // namespace koboshi::cli
