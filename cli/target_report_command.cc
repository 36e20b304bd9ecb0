#include "cli/commands.h"

#include <filesystem>
#include <memory>

#include <fmt/core.h>

#include "base/file/output_file.h"
#include "base/file/overwrite.h"
#include "simulation/host/qemu_host.h"
#include "simulation/record/summary.h"
#include "simulation/scenario/paths.h"
#include "simulation/scenario/reader.h"
#include "tools/target/target_report.h"

namespace koboshi::cli {
namespace {

struct TargetReportArguments {
  std::filesystem::path scenario = "scenarios/go.yaml";
  std::filesystem::path image;
  std::filesystem::path page;
  std::filesystem::path json;
};

void report_target(const TargetReportArguments& arguments) {
  const auto image = arguments.image.empty() ? simulation::default_image() : arguments.image;
  const auto scenario = simulation::find_input(simulation::InputKind::kScenario, arguments.scenario);
  for (const std::filesystem::path& out : {arguments.page, arguments.json})
    refuse_to_overwrite({scenario, image}, out);
  const tools::TargetReport report = tools::measure_target(simulation::read_scenario(scenario), image);
  if (!arguments.page.empty()) write_whole_file(arguments.page, tools::to_page(report, arguments.scenario));
  if (!arguments.json.empty()) simulation::write_json(arguments.json, tools::to_json(report));
  fmt::print("{}\n", tools::to_tables(report));
}

}  // namespace

void add_target_report_command(CLI::App& program, Invocation&) {
  auto arguments = std::make_shared<TargetReportArguments>();
  CLI::App* command = program.add_subcommand(
      "target-report", "Measure the firmware on a Cortex-M4: instructions, flash, RAM, stack");
  command->footer(
      R"(Plays a scenario with the firmware in QEMU, from the image that ./run target builds. The same image and
scenario give the same report, to the instruction.

Examples:
  koboshi target-report
  koboshi target-report --page docs/reference/target.md
)");
  command->add_option("SCENARIO", arguments->scenario, "A scenario's file or name")->capture_default_str();
  command->add_option("--image", arguments->image, "The image (default: the one that ./run target builds)");
  command->add_option("--json", arguments->json, "Also write the results to this file");
  command->add_option("--page", arguments->page, "Also write the reference page to this file");
  command->callback([arguments] { report_target(*arguments); });
}

}  // namespace koboshi::cli
